/* SPDX-License-Identifier: MIT
 *
 * The run-time half of meshlode for C (C99) and everything that can call C: open a .lode asset, choose what a camera
 * needs, load pages, decode clusters. Needs nothing but libc (and zstd, LZ4 where those codecs are built in).
 *
 *   meshlode_asset *asset;
 *   meshlode_error error;
 *   if (meshlode_open_file("scene.lode", &asset, &error) != MESHLODE_OK) { puts(error.text); return 1; }
 *   ...
 *   meshlode_close(asset);
 *
 * Units. Mesh space is the space of the source mesh, in its own ("object") units; stored spheres and decoded positions
 * are mesh space relative to meshlode_mesh.origin. World space is after meshlode_instance.transform. Errors are
 * distances in object units; MESHLODE_INFINITE_ERROR means "never passes".
 *
 * Ids are indices into the tables below, all global to the asset; MESHLODE_NONE is "no such id". The records are the
 * bytes of the file as docs/reference/format.md describes them, for a machine to read and for a GPU to be given as they
 * are.
 *
 * Errors. Functions that can fail return a meshlode_status and, where `error` is not NULL, leave the same status and a
 * text there (an empty text where nothing failed). Every byte of an asset is treated as hostile: opening checks every
 * offset, count, range and id of the tables, loading a page checks the page; nothing behind them can crash, hang or
 * read outside. A failed call leaves its outputs as they were, unless it says otherwise.
 *
 * Ownership. What a function returns a pointer to belongs to the asset and lives until meshlode_close; outputs go to
 * memory of the caller.
 *
 * Thread safety. An asset is immutable: any number of threads may use it at once. Closing it while another thread uses
 * it is a race.
 *
 * Not promised: a stable ABI before version 1 of the library; any caching (a page loaded twice is unpacked twice).
 */
#ifndef MESHLODE_MESHLODE_H
#define MESHLODE_MESHLODE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define MESHLODE_API __attribute__((visibility("default")))
#else
#define MESHLODE_API
#endif

#define MESHLODE_NONE 0xFFFFFFFFu
#define MESHLODE_INFINITE_ERROR 3.402823466e+38f
#define MESHLODE_MAX_CLUSTER_VERTICES 256
#define MESHLODE_MAX_CLUSTER_TRIANGLES 256
#define MESHLODE_MAX_PAGE_BYTES (128 * 1024)
#define MESHLODE_MAX_UV_SETS 4

typedef enum meshlode_status {
  MESHLODE_OK = 0,
  MESHLODE_USAGE = 1,   /* an argument that makes no sense */
  MESHLODE_IO = 2,      /* a file could not be read */
  MESHLODE_INVALID = 3, /* the bytes are not an asset; the text names the place in them */
  MESHLODE_OUT_OF_MEMORY = 4,
  MESHLODE_UNSUPPORTED = 5, /* a newer version, an unknown required section, a codec that is not built in */
  MESHLODE_TOO_SMALL = 7,   /* the caller's memory is too small; what is needed was stored where the function says */
  MESHLODE_BUILD_FAILED = 8 /* from <meshlode/meshlode_build.h> alone: cancelled, or not enough memory */
} meshlode_status;

typedef struct meshlode_error {
  meshlode_status status;
  char text[244]; /* "place: reason", UTF-8 as far as file names are, cut to fit, always terminated */
} meshlode_error;

typedef struct meshlode_asset meshlode_asset;

/* ------------------------------------------------------------------------------------------------------- opening */

/* The version of the file format that this library reads. */
MESHLODE_API uint32_t meshlode_format_version(void);

/* Maps the file; it must not shrink while it is open. Errors: MESHLODE_IO, MESHLODE_INVALID, MESHLODE_UNSUPPORTED. */
MESHLODE_API meshlode_status meshlode_open_file(const char* path, meshlode_asset** asset, meshlode_error* error);

/* Views the bytes, which must outlive the asset, stay unchanged, and lie at a multiple of 8. */
MESHLODE_API meshlode_status meshlode_open_buffer(const void* bytes, size_t size, meshlode_asset** asset,
                                                  meshlode_error* error);

/* NULL is allowed. */
MESHLODE_API void meshlode_close(meshlode_asset* asset);

/* -------------------------------------------------------------------------------------------------------- tables */

/* Bytes of the string section; see meshlode_text. */
typedef struct meshlode_string {
  uint32_t offset;
  uint32_t bytes;
} meshlode_string;

typedef enum meshlode_normal_mode {
  MESHLODE_NORMALS_NONE = 0, /* left out: use the geometric normal if you need one */
  MESHLODE_NORMALS_STORED = 1,
  MESHLODE_NORMALS_FLAT = 2 /* the geometric normal of each triangle is the shading normal */
} meshlode_normal_mode;

typedef struct meshlode_mesh {
  meshlode_string name;
  double origin[3];  /* mesh space, object units */
  int32_t grid_log2; /* position = origin + grid_mantissa * 2^grid_log2 * integer */
  uint32_t grid_mantissa;
  int32_t bounds_min[3]; /* of level 0, grid units */
  int32_t bounds_max[3];
  double diagonal;        /* of the source's bounding box, object units */
  float level0_deviation; /* how far quantization alone moves the surface at most, object units */
  uint32_t error_tier;    /* 0 qem, 1 measured, 2 certified */
  uint32_t normal_mode;   /* meshlode_normal_mode */
  uint32_t normal_scale;  /* a stored normal is off by at most sqrt(2) / normal_scale radians; 0 where none is stored */
  uint32_t uv_set_count;
  uint32_t has_color;                          /* 0 or 1 */
  int32_t uv_log2[MESHLODE_MAX_UV_SETS];       /* of each stored set: a UV is 2^uv_log2 * integer */
  uint8_t uv_set_source[MESHLODE_MAX_UV_SETS]; /* the TEXCOORD_n that stored set k was */
  uint32_t material;                           /* of every triangle; MESHLODE_NONE: decoding says which */
  int32_t sphere_log2;                         /* unit of the clusters' culling spheres: 2^sphere_log2 object units */
  uint32_t level_count;
  uint64_t source_triangles; /* before anything was dropped */
  uint64_t source_vertices;
  uint64_t dropped_degenerate; /* triangles without area that are no part of the source */
  uint64_t dropped_duplicate;  /* same positions, winding, stored attributes and material */
  uint64_t dropped_repaired;   /* by --repair: non-finite, out of range, degenerate, duplicate */
  uint64_t grid_collapsed;     /* triangles of level 0 without area on the grid; they stay */
  uint32_t first_group;        /* groups of a mesh are contiguous, coarse to fine */
  uint32_t group_count;
  uint32_t first_cluster; /* contiguous */
  uint32_t cluster_count;
  uint32_t first_node; /* BVH nodes are contiguous, the root is the first */
  uint32_t node_count;
} meshlode_mesh;

typedef struct meshlode_material {
  meshlode_string name;
  uint32_t source_index; /* index in the glTF's materials; MESHLODE_NONE for the default material */
  uint32_t alpha_mode;   /* 0 opaque, 1 mask, 2 blend */
  float base_color[4];
  float alpha_cutoff;
  uint32_t double_sided;
  uint32_t base_color_texture; /* glTF texture index; MESHLODE_NONE without */
  uint32_t base_color_uv_set;  /* TEXCOORD_n; MESHLODE_NONE without */
} meshlode_material;

#define MESHLODE_INSTANCE_MIRRORED 1u /* determinant < 0: flip culling */
#define MESHLODE_INSTANCE_SINGULAR 2u /* singular or not finite: not drawn */

typedef struct meshlode_instance {
  double transform[12]; /* mesh space to world, row-major 3x4 */
  double scale;         /* largest singular value of the 3x3 part, rounded up */
  uint32_t mesh;
  uint32_t node;  /* index of the glTF node */
  uint32_t flags; /* MESHLODE_INSTANCE_... */
  uint32_t reserved;
  meshlode_string name;
} meshlode_instance;

#define MESHLODE_GROUP_TERMINAL 1u  /* nothing coarser replaces its members: they are roots, its error is infinite */
#define MESHLODE_GROUP_STUCK 2u     /* terminal, and not because the top was reached */
#define MESHLODE_GROUP_AGGREGATE 4u /* its error is of coverage: the pixel size from which on as much is covered */

/* Clusters that are replaced together. Its error and sphere are the coarser values of its members and the own values of
 * the clusters made from it. */
typedef struct meshlode_group {
  float center[3]; /* LOD sphere, relative to meshlode_mesh.origin */
  float radius;
  /* The next five are MESHLODE_INFINITE_ERROR if terminal; the last three also where not measured. */
  float error;            /* selection error, object units */
  float quadric_error;    /* the simplifier's own estimate, object units */
  float deviation;        /* from the source, of this group alone and without the margin that error has, object units */
  float normal_deviation; /* shading normals against the source's, RMS, degrees */
  float uv_deviation;     /* UVs against the source's, 95% of the group is within it, UV units */
  uint32_t first_cluster; /* members, contiguous */
  uint32_t mesh;
  uint32_t page;
  uint16_t cluster_count;
  uint16_t level;        /* largest level of a member */
  uint16_t flags;        /* MESHLODE_GROUP_... */
  uint16_t stuck_reason; /* 0 not stuck, 1 locked, 2 flips, 3 seams, 4 loose components, 5 too small, 6 topology,
                            7 locked border */
} meshlode_group;

/* Drawn iff its own group's error passes (or it has none) and its coarser group's does not. */
typedef struct meshlode_cluster {
  int16_t center[3];      /* culling sphere, units of 2^meshlode_mesh.sphere_log2, relative to meshlode_mesh.origin */
  uint16_t radius;        /* same units */
  int8_t cone_axis[3];    /* normal cone, /127 */
  int8_t cone_cutoff;     /* /127: back-facing iff dot(view, axis) >= cutoff; 127 = never culled */
  uint32_t own_group;     /* the group it was made from; MESHLODE_NONE at level 0 */
  uint32_t coarser_group; /* the group that replaces it: the one it is a member of */
  uint8_t vertices_less_1;
  uint8_t triangles_less_1;
  uint16_t level;
} meshlode_cluster;

/* BVH over the groups of a mesh: a node that passes has nothing to draw below it. */
typedef struct meshlode_node {
  float center[3];
  float radius;
  float error;    /* largest group error below */
  uint32_t first; /* first child node (children are contiguous), or the group where child_count is 0 */
  uint32_t child_count;
} meshlode_node;

typedef struct meshlode_page {
  uint64_t offset; /* from the start of the file */
  uint32_t stored_bytes;
  uint32_t bytes; /* decoded, at most MESHLODE_MAX_PAGE_BYTES */
  uint32_t codec; /* 0 none, 1 lz4, 2 zstd, 3 draco, 4 strips */
  uint32_t first_group;
  uint32_t group_count;
  uint32_t first_cluster;
  uint32_t cluster_count;
  uint32_t first_dependency; /* see meshlode_page_dependencies */
  uint32_t dependency_count;
  uint32_t reserved;
  uint64_t checksum;
  uint64_t decoded_checksum;
} meshlode_page;

typedef struct meshlode_blob {
  meshlode_string name;
  meshlode_string mime_type;
  uint64_t offset; /* from the start of the file */
  uint64_t bytes;
  uint32_t kind; /* 1 image, 2 buffer */
  uint32_t source_index;
  uint64_t checksum;
} meshlode_blob;

/* Views of the asset's tables. `count` may not be NULL. An empty table may be NULL with count 0. */
MESHLODE_API const meshlode_mesh* meshlode_meshes(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_material* meshlode_materials(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_instance* meshlode_instances(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_group* meshlode_groups(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_cluster* meshlode_clusters(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_node* meshlode_nodes(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_page* meshlode_pages(const meshlode_asset* asset, uint32_t* count);
MESHLODE_API const meshlode_blob* meshlode_blobs(const meshlode_asset* asset, uint32_t* count);

/* The text of a record's string: UTF-8 as the source had it, `*bytes` long, not terminated. NULL and 0 where the
 * string is not one of this asset's. */
MESHLODE_API const char* meshlode_text(const meshlode_asset* asset, meshlode_string string, size_t* bytes);

/* An image's or buffer's bytes as they were in the source. NULL and 0 where there is no such blob. */
MESHLODE_API const void* meshlode_blob_bytes(const meshlode_asset* asset, uint32_t blob, size_t* bytes);

/* JSON, not terminated: source, settings, plan, what was left out; and, in the shape of glTF, nodes, materials,
 * textures, cameras, animations. */
MESHLODE_API const char* meshlode_meta_json(const meshlode_asset* asset, size_t* bytes);
MESHLODE_API const char* meshlode_scene_json(const meshlode_asset* asset, size_t* bytes);

/* ------------------------------------------------------------------------------------------------------ promises */

/* What a cut at t pixels is within t pixels of (docs/reference/selection.md). */
typedef enum meshlode_promise {
  MESHLODE_PROMISE_POSITION = 0,  /* positions; every asset has it, and it is chosen when one is opened */
  MESHLODE_PROMISE_TEXELS = 1,    /* texture coordinates too */
  MESHLODE_PROMISE_APPEARANCE = 2 /* and shading normals */
} meshlode_promise;

/* Chooses by which errors cuts are made: from here on level0_deviation of the meshes, and error of the groups and
 * nodes, are those of the promise, in the tables too, so that whoever selects on a GPU uploads them anew. Tables handed
 * out before stay valid until the next choice. Not while another thread uses the asset. Errors: MESHLODE_USAGE for no
 * enumerator; MESHLODE_UNSUPPORTED where the asset was not built with it. */
MESHLODE_API meshlode_status meshlode_choose_promise(meshlode_asset* asset, uint32_t promise, meshlode_error* error);

/* ----------------------------------------------------------------------------------------------------- selecting */

/* Where the scene is looked at from, as far as choosing a cut needs it: a view direction plays no part in it, and
 * nothing is culled. */
typedef struct meshlode_view {
  double eye[3]; /* world space; unused where orthographic */
  int is_orthographic;
  double fovy_radians;  /* full vertical angle, in (0, pi); perspective only */
  double ortho_height;  /* world units that the picture's height spans; orthographic only */
  double near_distance; /* world units, above 0: surfaces nearer than this count as this far */
  uint32_t height_px;   /* of the picture, at least 1 */
} meshlode_view;

/* Draw this cluster with this instance's transform. */
typedef struct meshlode_draw_item {
  uint32_t instance;
  uint32_t cluster;
} meshlode_draw_item;

/* What to draw so that no point of the surface moves by more than max(pixel_error, level 0's own deviation) pixels, as
 * far as the asset's error tier promises it. Each piece of each instance's surface is drawn exactly once, without
 * cracks within a mesh, whatever the camera. Ascending by (instance, cluster).
 * `*count` gets the number of items; at most `capacity` of them are stored in `items` (NULL where capacity is 0).
 * Errors: MESHLODE_USAGE for a view or pixel error that is not finite or not in its range; MESHLODE_TOO_SMALL where
 * capacity is below `*count`. */
MESHLODE_API meshlode_status meshlode_select_view(const meshlode_asset* asset, const meshlode_view* view,
                                                  double pixel_error, meshlode_draw_item* items, size_t capacity,
                                                  size_t* count, meshlode_error* error);

/* The cut of one mesh where each group whose error is at most `max_error` (object units, infinity is allowed) is
 * replaced by what is coarser; no camera. `*stored_error` (NULL allowed) gets the largest error in it, at least the
 * mesh's level0_deviation. Clusters, capacity and count as above. */
MESHLODE_API meshlode_status meshlode_select_uniform(const meshlode_asset* asset, uint32_t mesh, double max_error,
                                                     uint32_t* clusters, size_t capacity, size_t* count,
                                                     double* stored_error, meshlode_error* error);

/* --------------------------------------------------------------------------------------------- pages and clusters */

/* The page that holds a cluster; MESHLODE_NONE where there is no such cluster. */
MESHLODE_API uint32_t meshlode_page_of(const meshlode_asset* asset, uint32_t cluster);

/* The pages that must be there before this one is drawn, so that everything it holds can also be drawn coarser: all of
 * the same mesh, all with smaller ids, ascending. */
MESHLODE_API const uint32_t* meshlode_page_dependencies(const meshlode_asset* asset, uint32_t page, uint32_t* count);

/* An order in which to load all pages of the asset: each page comes after those it depends on, and the pages that hold
 * the largest errors come first, over all meshes, so that what is there at any time is the best for its size.
 * `pages` has room for one id per page of the asset. */
MESHLODE_API meshlode_status meshlode_streaming_order(const meshlode_asset* asset, uint32_t* pages,
                                                      meshlode_error* error);

/* Unpacks and checks a page into `out`, meshlode_page.bytes long, which must lie at a multiple of 4: its decoded,
 * GPU-ready form. Errors: MESHLODE_USAGE no such page, or unaligned memory; MESHLODE_INVALID with the place;
 * MESHLODE_UNSUPPORTED for a codec that is not built in; MESHLODE_TOO_SMALL. */
MESHLODE_API meshlode_status meshlode_load_page(const meshlode_asset* asset, uint32_t page, void* out, size_t capacity,
                                                meshlode_error* error);

/* The same without a copy: checks the page and gives its bytes in the asset. Errors: as above, and MESHLODE_UNSUPPORTED
 * where the page is stored compressed. */
MESHLODE_API meshlode_status meshlode_view_page(const meshlode_asset* asset, uint32_t page, const void** out,
                                                meshlode_error* error);

/* What meshlode_decode_* reads: the bytes of a page exactly as meshlode_load_page or meshlode_view_page of this very
 * asset gave them. They are not checked again: other bytes are the caller's mistake, with undefined behaviour. */
typedef struct meshlode_page_bytes {
  uint32_t page;
  const void* bytes;
} meshlode_page_bytes;

/* Caller's memory for one cluster. NULL: not wanted. Arrays hold MESHLODE_MAX_CLUSTER_VERTICES (… TRIANGLES) entries,
 * or as many as the capacities say. */
typedef struct meshlode_cluster_floats {
  uint32_t vertex_capacity;
  uint32_t triangle_capacity;
  float* positions;                 /* 3 per vertex: mesh space relative to meshlode_mesh.origin */
  float* normals;                   /* 3 per vertex, unit; untouched unless MESHLODE_NORMALS_STORED */
  float* uvs[MESHLODE_MAX_UV_SETS]; /* 2 per vertex; stored set k is the source's TEXCOORD_uv_set_source[k]; untouched
                                       from uv_set_count on */
  float* colors;                    /* 4 per vertex: linear, 0 … 1; untouched unless has_color */
  uint8_t* triangles;               /* 3 vertex indices per triangle, counter-clockwise */
  uint32_t* triangle_materials;     /* per triangle, an index into meshlode_materials */
  uint32_t vertex_count;            /* out */
  uint32_t triangle_count;          /* out */
} meshlode_cluster_floats;

/* Errors: MESHLODE_USAGE no such cluster, or the page is not its page; MESHLODE_TOO_SMALL with the counts stored. */
MESHLODE_API meshlode_status meshlode_decode_floats(const meshlode_asset* asset, meshlode_page_bytes page,
                                                    uint32_t cluster, meshlode_cluster_floats* out,
                                                    meshlode_error* error);

/* The integers of a cluster's vertices, exactly as stored: vertex i has values[i * channel_count + c], with the
 * channels in the order of docs/reference/format.md. */
typedef struct meshlode_cluster_integers {
  uint32_t value_capacity; /* of values: vertex_count * channel_count are needed */
  uint32_t triangle_capacity;
  int32_t* values;
  uint8_t* triangles;
  uint32_t* triangle_materials;
  uint32_t vertex_count;   /* out */
  uint32_t triangle_count; /* out */
  uint32_t channel_count;  /* out */
} meshlode_cluster_integers;

MESHLODE_API meshlode_status meshlode_decode_integers(const meshlode_asset* asset, meshlode_page_bytes page,
                                                      uint32_t cluster, meshlode_cluster_integers* out,
                                                      meshlode_error* error);

#ifdef __cplusplus
}
#endif

#endif /* MESHLODE_MESHLODE_H */
