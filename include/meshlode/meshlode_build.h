/* SPDX-License-Identifier: GPL-3.0-or-later */
/** \file
 * The builder for C (C99) and everything that can call C: arrays in memory become a .lode asset, in memory or in a
 * file. The same as <meshlode/build.h>, which says more about each member. The library is libmeshlode_build.
 *
 * \code
 *   meshlode_primitive_input primitive = {0};
 *   primitive.positions = xyz;
 *   primitive.vertex_count = n;
 *   primitive.indices = corners;
 *   primitive.triangle_count = m;
 *   primitive.material = MESHLODE_NONE;
 *   meshlode_mesh_input mesh = {"rock", &primitive, 1};
 *   meshlode_scene_input scene = {0};
 *   scene.meshes = &mesh;
 *   scene.mesh_count = 1;
 *   if (meshlode_build_to_file(&scene, NULL, "rock.lode", &error) != MESHLODE_OK) puts(error.text);
 * \endcode
 *
 * A NULL pointer is an array or text that is not given. Inputs belong to the caller and are not kept. Errors are a
 * status and, if `error` is not NULL, a text with the place ("meshes[0].primitives[2].indices[17]: ..."):
 * MESHLODE_USAGE for options, MESHLODE_INVALID for arrays, MESHLODE_IO, MESHLODE_UNSUPPORTED, and MESHLODE_BUILD_FAILED
 * if the build was cancelled or memory did not suffice. A failed call leaves its outputs as they were. The same input
 * and options give the same bytes for any number of threads.
 *
 * Not promised: a stable ABI before version 1 (docs/reference/compatibility.md).
 */
#ifndef MESHLODE_MESHLODE_BUILD_H
#define MESHLODE_MESHLODE_BUILD_H

#include <meshlode/meshlode.h>

#ifdef __cplusplus
extern "C" {
#endif

/** A list of triangles with one material. Exactly one of the two position arrays is given. */
typedef struct meshlode_primitive_input {
  const float* positions;                 /**< 3 per vertex: x y z, mesh space */
  const double* positions_double;         /**< instead of `positions`, for meshes far from their origin */
  const float* normals;                   /**< 3 per vertex; NULL: flat shading */
  const float* uvs[MESHLODE_MAX_UV_SETS]; /**< 2 per vertex; NULL: no such set */
  const float* colors;                    /**< 4 per vertex: r g b a, linear; NULL: white */
  size_t vertex_count;                    /**< vertices */
  const uint32_t* indices; /**< 3 per triangle, counter-clockwise seen from outside, below vertex_count */
  size_t triangle_count;   /**< triangles */
  uint32_t material;       /**< into the scene's materials; MESHLODE_NONE: the default one */
} meshlode_primitive_input;

/** A mesh. One DAG is built across all primitives: no cut has cracks between them. */
typedef struct meshlode_mesh_input {
  const char* name;                           /**< UTF-8 */
  const meshlode_primitive_input* primitives; /**< its primitives */
  size_t primitive_count;                     /**< 0: an empty mesh */
} meshlode_mesh_input;

/** A material, as far as the builder needs it. */
typedef struct meshlode_material_input {
  const char* name;      /**< UTF-8 */
  float base_color[4];   /**< r g b a, linear */
  uint32_t alpha_mode;   /**< 0 opaque, 1 mask, 2 blend */
  float alpha_cutoff;    /**< for mask */
  int double_sided;      /**< 0 or 1 */
  uint32_t uv_sets_used; /**< bit k: shaders sample set k; sets that no material uses are not stored */
} meshlode_material_input;

/** A mesh, drawn with a transform. */
typedef struct meshlode_instance_input {
  const char* name;     /**< UTF-8 */
  uint32_t mesh;        /**< into the scene's meshes */
  double transform[16]; /**< mesh space to world, column-major 4x4; the last row is 0 0 0 1 */
} meshlode_instance_input;

/** Everything that is built into one asset. */
typedef struct meshlode_scene_input {
  const char* name;                         /**< what the asset calls its source */
  const meshlode_mesh_input* meshes;        /**< its meshes */
  size_t mesh_count;                        /**< meshes */
  const meshlode_material_input* materials; /**< its materials */
  size_t material_count;                    /**< materials */
  const meshlode_instance_input* instances; /**< none: each mesh is drawn once, as it is */
  size_t instance_count;                    /**< instances */
} meshlode_scene_input;

/** Called by one thread at a time, not always the same one. Return 0 to go on; any other value ends the build with
 * MESHLODE_BUILD_FAILED. `fraction` is that of the whole build, 0 to 1. */
typedef int (*meshlode_build_progress)(double fraction, void* user);

/** The error tier that the preset has. */
#define MESHLODE_TIER_OF_PRESET MESHLODE_NONE

/** Options of a build. Fill them with meshlode_build_defaults first: members that are added later then have a sound
 * value. */
typedef struct meshlode_build_options {
  uint32_t error_tier;        /**< what errors mean: 0 qem, 1 measured, 2 certified, or MESHLODE_TIER_OF_PRESET */
  uint32_t preset;            /**< build time against quality: 0 fast, 1 default, 2 best */
  uint32_t attributes;        /**< what is stored: 0 auto, 1 none, 2 all */
  uint32_t keep;              /**< attributes to store always: bit 0 normals, bit 1 + k UV set k, bit 5 colours */
  uint32_t drop;              /**< attributes to store never, same bits; none of `keep` */
  uint32_t codec;             /**< of pages on disk: 4 strips, 0 none */
  uint32_t strip_effort;      /**< search effort for shorter strips: 0 as preset, 1 fast, 2 default, 3 best */
  uint32_t cluster_triangles; /**< maximum triangles per cluster, 1 to 256 */
  uint32_t group_clusters;    /**< target clusters per group, 4 to 32 */
  double grid_step;           /**< mesh units, for meshes that must meet; 0: from position_error */
  double position_error;      /**< largest move of a vertex, mesh units; 0: chosen, invisible. Not with grid_step */
  double normal_error;        /**< largest error of a stored normal, degrees, above 0 to 180 */
  double uv_error;            /**< largest move of a texture coordinate; 0: chosen, invisible */
  int uv_error_is_texels;     /**< unit of uv_error: 0 UV units, 1 texels */
  int repair;                 /**< remove broken, degenerate and duplicate triangles, orient the rest */
  int linear_colors;          /**< colour levels of PLY and STL are linear, not sRGB */
  int keep_topology;          /**< every cut of a manifold is one, with its holes, handles and pieces */
  int lock_borders;           /**< open borders keep every vertex in every cut: tiles with one grid_step meet */
  int keep_layers;            /**< surfaces close above one another stay in order; 0: gaps are not kept */
  uint32_t page_size;         /**< largest page, KiB: 16, 32, 64 or 128; a larger group has a page of its own */
  uint32_t page_order;        /**< of groups inside a level: 0 as built, 1 those together that views need together */
  uint32_t root_bytes;        /**< limit of each mesh's first page, 16,384 to 131,072; 0: as page_size */
  int page_hints;             /**< the file has a sphere and errors of each page (meshlode_page_hint) */
  uint32_t aggregate;         /**< simplified by coverage: 4 masked cards, 0 nothing, 1 auto, 2 all small pieces,
                                   3 aggregate_names */
  const char*
      aggregate_names;       /**< names of meshes and materials, comma-separated, with * and ?; may be NULL unless 3 */
  uint32_t promise;          /**< errors cover: 0 positions, 1 texels too, 2 appearance too */
  uint64_t max_memory_bytes; /**< limit for the process; 0: what the machine has left */
  uint32_t thread_count;     /**< threads at most; 0: all */
  meshlode_build_progress on_progress; /**< may be NULL */
  void* user;                          /**< passed to on_progress */
} meshlode_build_options;

/** Fills options with the defaults of the command line. */
MESHLODE_API void meshlode_build_defaults(meshlode_build_options* options);

/** Builds an asset in memory, as meshlode_open_buffer takes it. Free it with meshlode_build_free. NULL options: the
 * defaults. */
MESHLODE_API meshlode_status meshlode_build_to_buffer(const meshlode_scene_input* scene,
                                                      const meshlode_build_options* options, void** bytes, size_t* size,
                                                      meshlode_error* error);
/** Frees what meshlode_build_to_buffer returned. NULL is allowed. */
MESHLODE_API void meshlode_build_free(void* bytes);

/** Builds an asset into a file, which appears whole or not at all. */
MESHLODE_API meshlode_status meshlode_build_to_file(const meshlode_scene_input* scene,
                                                    const meshlode_build_options* options, const char* path,
                                                    meshlode_error* error);

#ifdef __cplusplus
}
#endif

#endif
