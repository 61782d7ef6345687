/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The build half of meshlode for C (C99) and everything that can call C: arrays in memory become a .lode asset, in
 * memory or in a file. The same as <meshlode/build.h>, which says more of each member; the library is
 * libmeshlode_build.
 *
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
 *
 * Pointers that are NULL are arrays or texts that are not there. Inputs belong to the caller and are not kept. Errors
 * are a status and, where `error` is not NULL, a text with the place ("meshes[0].primitives[2].indices[17]: …"):
 * MESHLODE_USAGE for options, MESHLODE_INVALID for arrays, MESHLODE_IO, MESHLODE_UNSUPPORTED, and MESHLODE_BUILD_FAILED
 * where it was cancelled or memory did not suffice. A failed call leaves its outputs as they were. The same input and
 * options give the same bytes for any number of threads.
 *
 * Not promised: a stable ABI before version 1 of the library.
 */
#ifndef MESHLODE_MESHLODE_BUILD_H
#define MESHLODE_MESHLODE_BUILD_H

#include <meshlode/meshlode.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A triangle list with one material; exactly one of the two position arrays is given. */
typedef struct meshlode_primitive_input {
  const float* positions;                 /* 3 a vertex: x y z, mesh space */
  const double* positions_double;         /* instead of `positions`, for meshes far from their origin */
  const float* normals;                   /* 3 a vertex; NULL: flat shading is meant */
  const float* uvs[MESHLODE_MAX_UV_SETS]; /* 2 a vertex; NULL: no such set */
  const float* colors;                    /* 4 a vertex: r g b a, linear; NULL: white */
  size_t vertex_count;
  const uint32_t* indices; /* 3 a triangle, counter-clockwise seen from outside */
  size_t triangle_count;
  uint32_t material; /* into the scene's materials; MESHLODE_NONE: the default one */
} meshlode_primitive_input;

/* One DAG is built across all primitives: there are no cracks between them in any cut. */
typedef struct meshlode_mesh_input {
  const char* name; /* UTF-8 */
  const meshlode_primitive_input* primitives;
  size_t primitive_count;
} meshlode_mesh_input;

typedef struct meshlode_material_input {
  const char* name;
  float base_color[4]; /* linear */
  uint32_t alpha_mode; /* 0 opaque, 1 mask, 2 blend */
  float alpha_cutoff;  /* for mask */
  int double_sided;
  uint32_t uv_sets_used; /* bit k: shaders sample set k; sets that no material uses are not stored */
} meshlode_material_input;

typedef struct meshlode_instance_input {
  const char* name;
  uint32_t mesh;
  double transform[16]; /* mesh space to world, column by column; the last row is 0 0 0 1 */
} meshlode_instance_input;

typedef struct meshlode_scene_input {
  const char* name; /* what the asset calls its source */
  const meshlode_mesh_input* meshes;
  size_t mesh_count;
  const meshlode_material_input* materials;
  size_t material_count;
  const meshlode_instance_input* instances; /* none: each mesh is drawn once, as it is */
  size_t instance_count;
} meshlode_scene_input;

/* Called from one thread at a time, not always the same one; 0: go on, else the build ends with MESHLODE_BUILD_FAILED.
 * `fraction`: of the whole build, 0 to 1. */
typedef int (*meshlode_build_progress)(double fraction, void* user);

#define MESHLODE_TIER_OF_PRESET MESHLODE_NONE

/* Fill it with meshlode_build_defaults first: members that are added later then have a sound value. */
typedef struct meshlode_build_options {
  uint32_t error_tier; /* 0 qem, 1 measured, 2 certified, or MESHLODE_TIER_OF_PRESET */
  uint32_t preset;     /* 0 fast, 1 default, 2 best */
  uint32_t attributes; /* 0 auto, 1 none, 2 all */
  /* Sets of attributes, bit 0 normals, bit 1 + k UV set k, bit 5 colours: stored although `attributes` would not, where
   * the source has them, and not stored although it would. None is in both. */
  uint32_t keep, drop;
  uint32_t codec;        /* of the pages on disk: 0 none, 1 LZ4, 2 Zstandard, 3 Draco, 4 strips */
  uint32_t strip_effort; /* how long fewer bytes a triangle are looked for: 0 as preset, 1 fast, 2 default, 3 best */
  uint32_t cluster_triangles; /* the most of a cluster, 1 to 256 */
  uint32_t group_clusters;    /* how many are simplified together, about: 4 to 32 */
  double grid_step, position_error, normal_error, uv_error;
  int uv_error_is_texels;
  int repair;
  int linear_colors; /* colour levels of PLY and STL are linear, not sRGB */
  int keep_topology; /* every cut of a manifold is one, with its holes, handles and pieces */
  int lock_borders;  /* open borders keep every vertex in every cut: tiles with one grid_step abut at any levels */
  /* What is thinned out by coverage: 0 nothing, 1 meshes and parts of many small pieces, 2 all small pieces, 3 those of
   * meshes and materials by aggregate_names: comma by comma, '*' is any characters and '?' is one. */
  uint32_t aggregate;
  const char* aggregate_names; /* may be NULL where `aggregate` is not 3 */
  uint32_t promise; /* what errors there are of: 0 positions, 1 texels too, 2 appearance too; works with every tier */
  uint64_t max_memory_bytes;
  uint32_t thread_count; /* 0: all */
  meshlode_build_progress on_progress;
  void* user; /* what on_progress is given */
} meshlode_build_options;

MESHLODE_API void meshlode_build_defaults(meshlode_build_options* options);

/* The bytes of an asset, as meshlode_open_buffer takes them; give them back with meshlode_build_free. `options` may be
 * NULL: the defaults. */
MESHLODE_API meshlode_status meshlode_build_to_buffer(const meshlode_scene_input* scene,
                                                      const meshlode_build_options* options, void** bytes, size_t* size,
                                                      meshlode_error* error);
/* NULL is allowed. */
MESHLODE_API void meshlode_build_free(void* bytes);

/* The file appears whole or not at all. */
MESHLODE_API meshlode_status meshlode_build_to_file(const meshlode_scene_input* scene,
                                                    const meshlode_build_options* options, const char* path,
                                                    meshlode_error* error);

#ifdef __cplusplus
}
#endif

#endif
