/* SPDX-License-Identifier: MIT */
/** \file
 * The runtime for C (C99) and everything that can call C: open a .lode asset, choose what a camera needs, load pages,
 * decode clusters. Needs libc alone (with MESHLODE_OLD_CODECS also zstd, LZ4 and Draco).
 *
 * \code
 *   meshlode_asset *asset;
 *   meshlode_error error;
 *   if (meshlode_open_file("scene.lode", &asset, &error) != MESHLODE_OK) { puts(error.text); return 1; }
 *   ...
 *   meshlode_close(asset);
 * \endcode
 *
 * Units. Mesh space is the space of the source mesh, in its own ("object") units. Stored spheres and decoded positions
 * are mesh space relative to meshlode_mesh.origin. World space is after meshlode_instance.transform. Errors are
 * distances in object units; MESHLODE_INFINITE_ERROR means "never passes".
 *
 * Ids are indices into the tables below, all global to the asset; MESHLODE_NONE is "no such id". The records are the
 * bytes of the file as docs/reference/format.md describes them, to be read, or uploaded to a GPU as they are.
 *
 * Errors. Functions that can fail return a meshlode_status. If `error` is not NULL, they also store the status and a
 * text there (an empty text on success). Every byte of an asset is treated as hostile: opening checks every offset,
 * count, range and id of the tables, loading a page checks the page. After that nothing can crash, hang or read
 * outside. A failed call leaves its outputs as they were, unless it says otherwise.
 *
 * Ownership. Returned pointers belong to the asset and are valid until meshlode_close. Outputs go to memory of the
 * caller.
 *
 * Thread safety. Any number of threads may use an asset at once, each with a selector of its own, except while one
 * calls meshlode_close.
 *
 * Not promised: a stable ABI before version 1 (docs/reference/compatibility.md); caching (a page loaded twice is
 * unpacked twice).
 */
#ifndef MESHLODE_MESHLODE_H
#define MESHLODE_MESHLODE_H

#include <stddef.h>
#include <stdint.h>

#include <meshlode/version.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Marks the functions of the shared libraries. */
#if defined(__GNUC__)
#define MESHLODE_API __attribute__((visibility("default")))
#else
#define MESHLODE_API
#endif

#define MESHLODE_NONE 0xFFFFFFFFu                /**< no such id */
#define MESHLODE_INFINITE_ERROR 3.402823466e+38f /**< an error that never passes, or was not measured */
#define MESHLODE_MAX_CLUSTER_VERTICES 256        /**< of one cluster */
#define MESHLODE_MAX_CLUSTER_TRIANGLES 256       /**< of one cluster */
#define MESHLODE_MAX_PAGE_BYTES (128 * 1024)     /**< of one decoded page */
#define MESHLODE_MAX_UV_SETS 4                   /**< that a mesh stores at most */

/** What came of a call. 1 to 5 are the exit codes of the command line. */
typedef enum meshlode_status {
  MESHLODE_OK = 0,            /**< success */
  MESHLODE_USAGE = 1,         /**< an argument is outside its documented range */
  MESHLODE_IO = 2,            /**< a file could not be read */
  MESHLODE_INVALID = 3,       /**< the bytes are not an asset; the text names the place in them */
  MESHLODE_OUT_OF_MEMORY = 4, /**< memory ran out */
  MESHLODE_UNSUPPORTED = 5,   /**< a newer version, an unknown required section, a codec that is not built in */
  MESHLODE_TOO_SMALL = 7,     /**< the caller's memory is too small; the required size was stored */
  MESHLODE_BUILD_FAILED = 8   /**< a build was cancelled or needs more memory (meshlode_build.h) */
} meshlode_status;

/** Why a call failed. */
typedef struct meshlode_error {
  meshlode_status status; /**< the returned status */
  char text[244];         /**< "place: reason", UTF-8 if file names are, cut to fit, always terminated */
} meshlode_error;

/** An open asset. */
typedef struct meshlode_asset meshlode_asset;

/* ------------------------------------------------------------------------------------------------------- opening */

/** The version of the loaded library: MESHLODE_VERSION of its headers, major * 10000 + minor * 100 + patch. */
MESHLODE_API uint32_t meshlode_version(void);

/** The newest version of the file format that this library reads; it reads all earlier ones too. */
MESHLODE_API uint32_t meshlode_format_version(void);

/** Maps a file, which must not shrink while it is open. Errors: MESHLODE_IO; MESHLODE_INVALID with the place in the
 * file; MESHLODE_UNSUPPORTED for a newer version or an unknown required section. */
MESHLODE_API meshlode_status meshlode_open_file(const char* path, meshlode_asset** asset, meshlode_error* error);

/** Opens an asset in memory. The bytes must outlive the asset, stay unchanged, and be aligned to 8. Errors as above. */
MESHLODE_API meshlode_status meshlode_open_buffer(const void* bytes, size_t size, meshlode_asset** asset,
                                                  meshlode_error* error);

/** Bytes of the file. */
typedef struct meshlode_range {
  uint64_t offset; /**< from the start of the file */
  uint64_t bytes;  /**< length */
} meshlode_range;

/** How many of a file's first bytes meshlode_open_head needs: all that lies before its pages and images. `first` are
 * the first `size` bytes, at any address, of a file of `file_bytes`. On success `*needed` is the size of the head.
 * MESHLODE_TOO_SMALL: to say it, `*needed` of the first bytes are needed; ask again with them. `*needed` is never above
 * `file_bytes`. Other errors: MESHLODE_INVALID with the place; MESHLODE_UNSUPPORTED for a newer version, or where
 * tables lie behind pages or images, which `meshlode build` never writes. */
MESHLODE_API meshlode_status meshlode_head_bytes(const void* first, size_t size, uint64_t file_bytes, uint64_t* needed,
                                                 meshlode_error* error);

/** Opens an asset by its head: the first bytes of a file of `file_bytes`, as many as meshlode_head_bytes says or more.
 * Tables, texts and selections are as those of the whole file. meshlode_load_page and meshlode_view_page fail, and
 * meshlode_blob_bytes is NULL: pages and images are for the caller to read (meshlode_page_range, meshlode_unpack_page,
 * meshlode_blob_range, meshlode_check_blob). The bytes must outlive the asset, stay unchanged, and be aligned to 8.
 * Errors: those of meshlode_open_buffer; MESHLODE_INVALID where the head is cut off. */
MESHLODE_API meshlode_status meshlode_open_head(const void* bytes, size_t size, uint64_t file_bytes,
                                                meshlode_asset** asset, meshlode_error* error);

/** Closes an asset. NULL is allowed. */
MESHLODE_API void meshlode_close(meshlode_asset* asset);

/* -------------------------------------------------------------------------------------------------------- tables */

/** A text of the string section; see meshlode_text. */
typedef struct meshlode_string {
  uint32_t offset; /**< in the string section */
  uint32_t bytes;  /**< length */
} meshlode_string;

/** Where the shading normals of a mesh come from. */
typedef enum meshlode_normal_mode {
  MESHLODE_NORMALS_NONE = 0,   /**< not stored: use the geometric normal if you need one */
  MESHLODE_NORMALS_STORED = 1, /**< one per vertex */
  MESHLODE_NORMALS_FLAT = 2    /**< the geometric normal of each triangle is the shading normal */
} meshlode_normal_mode;

/** A mesh: where its parts are in the other tables, and how its numbers are stored. */
typedef struct meshlode_mesh {
  meshlode_string name;   /**< as in the source */
  double origin[3];       /**< mesh space, object units */
  int32_t grid_log2;      /**< position = origin + grid_mantissa * 2^grid_log2 * integer */
  uint32_t grid_mantissa; /**< see grid_log2 */
  int32_t bounds_min[3];  /**< of level 0, grid units */
  int32_t bounds_max[3];  /**< of level 0, grid units */
  double diagonal;        /**< of the bounding box of the source, object units */
  float level0_deviation; /**< largest move of the surface by quantization, object units */
  uint32_t error_tier;    /**< 0 qem, 1 measured, 2 certified */
  uint32_t normal_mode;   /**< meshlode_normal_mode */
  uint32_t
      normal_scale; /**< a stored normal is off by at most sqrt(2) / normal_scale radians; 0 where none is stored */
  uint32_t uv_set_count;                       /**< stored UV sets, at most MESHLODE_MAX_UV_SETS */
  uint32_t has_color;                          /**< 0 or 1 */
  int32_t uv_log2[MESHLODE_MAX_UV_SETS];       /**< of each stored set: a UV is 2^uv_log2 * integer */
  uint8_t uv_set_source[MESHLODE_MAX_UV_SETS]; /**< stored set k is TEXCOORD_n of the source */
  uint32_t material;                           /**< of every triangle; MESHLODE_NONE: decoding says which */
  int32_t sphere_log2;                         /**< unit of the clusters' culling spheres: 2^sphere_log2 object units */
  uint32_t level_count;                        /**< levels, 0 the finest */
  uint64_t source_triangles;                   /**< before anything was dropped */
  uint64_t source_vertices;                    /**< before anything was dropped */
  uint64_t dropped_degenerate;                 /**< triangles without area that are not part of the source */
  uint64_t dropped_duplicate;                  /**< same positions, winding, stored attributes and material */
  uint64_t dropped_repaired;                   /**< by --repair: non-finite, out of range, degenerate, duplicate */
  uint64_t grid_collapsed;                     /**< triangles of level 0 without area on the grid; they stay */
  uint32_t first_group;                        /**< groups of a mesh are contiguous, coarse to fine */
  uint32_t group_count;                        /**< groups of this mesh */
  uint32_t first_cluster;                      /**< clusters of a mesh are contiguous */
  uint32_t cluster_count;                      /**< clusters of this mesh */
  uint32_t first_node;                         /**< BVH nodes are contiguous, the root is the first */
  uint32_t node_count;                         /**< nodes of this mesh */
} meshlode_mesh;

/** What drawing needs of a material; the rest is in meshlode_scene_json. */
typedef struct meshlode_material {
  meshlode_string name;        /**< as in the source */
  uint32_t source_index;       /**< index in the glTF's materials; MESHLODE_NONE for the default material */
  uint32_t alpha_mode;         /**< 0 opaque, 1 mask, 2 blend */
  float base_color[4];         /**< r g b a, linear */
  float alpha_cutoff;          /**< for mask */
  uint32_t double_sided;       /**< 0 or 1 */
  uint32_t base_color_texture; /**< glTF texture index; MESHLODE_NONE without */
  uint32_t base_color_uv_set;  /**< TEXCOORD_n; MESHLODE_NONE without */
} meshlode_material;

#define MESHLODE_INSTANCE_MIRRORED 1u /**< determinant < 0: flip culling */
#define MESHLODE_INSTANCE_SINGULAR 2u /**< singular or not finite: not drawn */

/** A mesh, drawn with a transform. */
typedef struct meshlode_instance {
  double transform[12]; /**< mesh space to world, row-major 3x4 */
  double scale;         /**< largest singular value of the 3x3 part, rounded up */
  uint32_t mesh;        /**< into meshlode_meshes */
  uint32_t node;        /**< index of the glTF node */
  uint32_t flags;       /**< MESHLODE_INSTANCE_... */
  uint32_t reserved;    /**< 0 */
  meshlode_string name; /**< of the node */
} meshlode_instance;

#define MESHLODE_GROUP_TERMINAL 1u  /**< nothing coarser replaces its members: they are roots, its error is infinite */
#define MESHLODE_GROUP_STUCK 2u     /**< terminal, and not because the top was reached */
#define MESHLODE_GROUP_AGGREGATE 4u /**< its error is the pixel size from which on it covers as much as the source */

/** A set of neighbouring clusters (its members) that are replaced together by coarser clusters. The renderer compares
 * `error`, seen at the nearest point of the sphere, with the allowed error: if it is small enough, the replacement is
 * drawn, else the members (docs/reference/selection.md). To a member this is its coarser group, to a replacement its
 * own group. */
typedef struct meshlode_group {
  float center[3]; /**< of the LOD sphere, relative to meshlode_mesh.origin */
  float radius;    /**< of the LOD sphere, object units */
  /* The next five are MESHLODE_INFINITE_ERROR if terminal; the last three also if not measured. */
  float error;         /**< selection error, object units */
  float quadric_error; /**< the simplifier's own estimate, object units */
  float deviation;     /**< distance of this group alone from the source, without the margin of error, object units */
  float normal_deviation; /**< of shading normals from the source's, root mean square, degrees */
  float uv_deviation;     /**< of UVs from the source's, 95% of the group is within it, UV units */
  uint32_t first_cluster; /**< members, contiguous */
  uint32_t mesh;          /**< into meshlode_meshes */
  uint32_t page;          /**< that holds its members */
  uint16_t cluster_count; /**< members */
  uint16_t level;         /**< largest level of a member */
  uint16_t flags;         /**< MESHLODE_GROUP_... */
  uint16_t stuck_reason;  /**< 0 not stuck, 1 locked, 2 flips, 3 seams, 4 loose components, 5 too small, 6 topology,
                               7 locked border */
} meshlode_group;

/** Up to 256 triangles that are drawn together: drawn if and only if its own group passes (or it has none) and its
 * coarser group does not. */
typedef struct meshlode_cluster {
  int16_t center[3];   /**< culling sphere, units of 2^meshlode_mesh.sphere_log2, relative to meshlode_mesh.origin */
  uint16_t radius;     /**< of the culling sphere, same units */
  int8_t cone_axis[3]; /**< axis of the normal cone, times 127, mesh space */
  /** All triangles face away from an eye that looks along the unit vector v (from the eye to the surface, mesh space)
   * if dot(v, cone_axis / 127) >= cone_cutoff / 127. For a perspective view test it for every v that reaches the
   * culling sphere. 127: never cull. Not for double-sided materials. */
  int8_t cone_cutoff;
  uint32_t own_group;       /**< the group it was made from; MESHLODE_NONE at level 0 */
  uint32_t coarser_group;   /**< the group that replaces it: the one it is a member of */
  uint8_t vertices_less_1;  /**< number of vertices, less 1 */
  uint8_t triangles_less_1; /**< number of triangles, less 1 */
  uint16_t level;           /**< 0 the source */
} meshlode_cluster;

/** A node of the BVH over the groups of a mesh: if it passes, there is nothing to draw below it. */
typedef struct meshlode_node {
  float center[3];      /**< of its sphere, relative to meshlode_mesh.origin */
  float radius;         /**< of its sphere, object units */
  float error;          /**< largest group error below */
  uint32_t first;       /**< first child node (children are contiguous), or the group if child_count is 0 */
  uint32_t child_count; /**< 0: a leaf */
} meshlode_node;

/** A page: the unit of loading. */
typedef struct meshlode_page {
  uint64_t offset;           /**< from the start of the file */
  uint32_t stored_bytes;     /**< in the file */
  uint32_t bytes;            /**< decoded, at most MESHLODE_MAX_PAGE_BYTES */
  uint32_t codec;            /**< 0 none, 1 lz4, 2 zstd, 3 draco, 4 strips */
  uint32_t first_group;      /**< groups of a page are contiguous */
  uint32_t group_count;      /**< groups of this page */
  uint32_t first_cluster;    /**< clusters of a page are contiguous */
  uint32_t cluster_count;    /**< clusters of this page */
  uint32_t first_dependency; /**< see meshlode_page_dependencies */
  uint32_t dependency_count; /**< see meshlode_page_dependencies */
  uint32_t reserved;         /**< 0 */
  uint64_t checksum;         /**< XXH3-64 of the stored bytes */
  uint64_t decoded_checksum; /**< XXH3-64 of the decoded bytes */
} meshlode_page;

/** An image or buffer of the source, as it was. */
typedef struct meshlode_blob {
  meshlode_string name;      /**< as in the source */
  meshlode_string mime_type; /**< such as "image/png" */
  uint64_t offset;           /**< from the start of the file */
  uint64_t bytes;            /**< length */
  uint32_t kind;             /**< 1 image, 2 buffer */
  uint32_t source_index;     /**< in the glTF's images or buffers */
  uint64_t checksum;         /**< XXH3-64 of the bytes */
} meshlode_blob;

/* Views of the tables of an asset. `count` may not be NULL. An empty table may be NULL with count 0. */

/** Meshes of the asset, `*count` of them. */
MESHLODE_API const meshlode_mesh* meshlode_meshes(const meshlode_asset* asset, uint32_t* count);
/** Materials of the asset, `*count` of them. */
MESHLODE_API const meshlode_material* meshlode_materials(const meshlode_asset* asset, uint32_t* count);
/** Instances of the asset, `*count` of them. */
MESHLODE_API const meshlode_instance* meshlode_instances(const meshlode_asset* asset, uint32_t* count);
/** Groups of the asset, `*count` of them. */
MESHLODE_API const meshlode_group* meshlode_groups(const meshlode_asset* asset, uint32_t* count);
/** Clusters of the asset, `*count` of them. */
MESHLODE_API const meshlode_cluster* meshlode_clusters(const meshlode_asset* asset, uint32_t* count);
/** BVH nodes of the asset, `*count` of them. */
MESHLODE_API const meshlode_node* meshlode_nodes(const meshlode_asset* asset, uint32_t* count);
/** Pages of the asset, `*count` of them. */
MESHLODE_API const meshlode_page* meshlode_pages(const meshlode_asset* asset, uint32_t* count);
/** Images and buffers of the asset, `*count` of them. */
MESHLODE_API const meshlode_blob* meshlode_blobs(const meshlode_asset* asset, uint32_t* count);

/** The text of a record's string: UTF-8 as the source had it, `*bytes` long, not terminated. NULL and 0 if the string
 * is not one of this asset's. */
MESHLODE_API const char* meshlode_text(const meshlode_asset* asset, meshlode_string string, size_t* bytes);

/** The bytes of an image or buffer as they were in the source. NULL and 0 if there is no such blob, or of a head. */
MESHLODE_API const void* meshlode_blob_bytes(const meshlode_asset* asset, uint32_t blob, size_t* bytes);

/** Where they lie in the file; zeros if there is no such blob. */
MESHLODE_API meshlode_range meshlode_blob_range(const meshlode_asset* asset, uint32_t blob);

/** Checks bytes of a blob that the caller read, by their number and checksum. Errors: MESHLODE_USAGE no such blob, or
 * another number of bytes; MESHLODE_INVALID. */
MESHLODE_API meshlode_status meshlode_check_blob(const meshlode_asset* asset, uint32_t blob, const void* bytes,
                                                 size_t size, meshlode_error* error);

/** The glTF image of a glTF texture, such as meshlode_material.base_color_texture, and the blob that is a glTF image;
 * MESHLODE_NONE where there is none, or the asset does not hold the image. They read meshlode_scene_json from its
 * start: ask once. */
MESHLODE_API uint32_t meshlode_image_of_texture(const meshlode_asset* asset, uint32_t texture);
/** See meshlode_image_of_texture. */
MESHLODE_API uint32_t meshlode_blob_of_image(const meshlode_asset* asset, uint32_t image);

/** JSON, `*bytes` long, not terminated: source, settings, plan, what was left out. */
MESHLODE_API const char* meshlode_meta_json(const meshlode_asset* asset, size_t* bytes);
/** JSON in the shape of glTF, `*bytes` long, not terminated: nodes, materials, textures, cameras, animations. */
MESHLODE_API const char* meshlode_scene_json(const meshlode_asset* asset, size_t* bytes);

/* ------------------------------------------------------------------------------------------------------ promises */

/** What errors cover: a cut at t pixels is within t pixels of the source in these (docs/reference/selection.md). */
typedef enum meshlode_promise {
  MESHLODE_PROMISE_POSITION = 0,  /**< positions; every asset has it */
  MESHLODE_PROMISE_TEXELS = 1,    /**< texture coordinates too */
  MESHLODE_PROMISE_APPEARANCE = 2 /**< and shading normals */
} meshlode_promise;

/** The tables that hold errors: as meshlode_meshes, meshlode_groups and meshlode_nodes, which have the errors of
 * positions, but level0_deviation of the meshes and error of the groups and nodes are those of a promise. */
typedef struct meshlode_promise_tables {
  const meshlode_mesh* meshes;  /**< as many as meshlode_meshes */
  const meshlode_group* groups; /**< as many as meshlode_groups */
  const meshlode_node* nodes;   /**< as many as meshlode_nodes */
} meshlode_promise_tables;

/** What to upload to select by a promise on a GPU. Errors: MESHLODE_USAGE for an unknown value; MESHLODE_UNSUPPORTED if
 * the asset was not built with it. */
MESHLODE_API meshlode_status meshlode_tables_of(const meshlode_asset* asset, uint32_t promise,
                                                meshlode_promise_tables* tables, meshlode_error* error);

/* ----------------------------------------------------------------------------------------------------- selecting */

/** Where the scene is seen from. The rule looks at distances only: a view direction plays no part, and nothing is
 * culled but by a meshlode_frustum. */
typedef struct meshlode_view {
  double eye[3];        /**< world space, finite; if orthographic, only a frustum made of it uses it */
  int is_orthographic;  /**< 0: perspective */
  double fovy_radians;  /**< full vertical angle, in (0, pi); perspective only */
  double ortho_height;  /**< world units across the height of the picture, above 0; orthographic only */
  double near_distance; /**< world units, above 0: nearer surfaces count as this far */
  uint32_t height_px;   /**< height of the picture, at least 1 */
  uint32_t promise;     /**< meshlode_promise: by which errors the cut is made */
} meshlode_view;

/** Draw this cluster with this instance's transform. */
typedef struct meshlode_draw_item {
  uint32_t instance; /**< into meshlode_instances */
  uint32_t cluster;  /**< into meshlode_clusters */
} meshlode_draw_item;

/** Chooses what to draw so that no point of the surface moves by more than max(pixel_error, level0_deviation in
 * pixels), as far as the asset's error tier guarantees. Each piece of each instance's surface is drawn exactly once,
 * without cracks within a mesh, whatever the camera. Items ascend by (instance, cluster). Singular instances are not
 * drawn. \param asset        an open asset; its pages need not be loaded \param view         the camera \param
 * pixel_error  allowed error in pixels, finite and at least 0; 0 selects the finest level \param items        room for
 * `capacity` items; NULL if that is 0 \param capacity     number of items that fit \param count        gets the number
 * of items of the cut \param error        may be NULL \return MESHLODE_USAGE if a member of `view` or pixel_error is
 * outside its range; MESHLODE_UNSUPPORTED if the asset was not built with the view's promise; MESHLODE_TOO_SMALL if
 * capacity is below
 * `*count`. A call for the count alone costs as much as one for the items: keep the memory between frames. */
MESHLODE_API meshlode_status meshlode_select_view(const meshlode_asset* asset, const meshlode_view* view,
                                                  double pixel_error, meshlode_draw_item* items, size_t capacity,
                                                  size_t* count, meshlode_error* error);

/** The view volume, world space: a point p is inside where a p.x + b p.y + c p.z + d >= 0 for each plane a, b, c, d.
 * Planes may have any length and look any way; one of zeros has everything inside. */
typedef struct meshlode_frustum {
  double planes[6][4]; /**< finite */
} meshlode_frustum;

/** The view volume of a camera: four sides and the plane through the eye, and no far one. `target` is a point that it
 * looks at and `up` points to the top of the picture; `aspect` is width over height. Errors: MESHLODE_USAGE for a
 * member of `view` outside its range, or what makes no picture. */
MESHLODE_API meshlode_status meshlode_make_frustum(const meshlode_view* view, const double target[3],
                                                   const double up[3], double aspect, meshlode_frustum* frustum,
                                                   meshlode_error* error);

/** meshlode_select_view less the items whose culling sphere is outside `frustum`; NULL culls nothing. */
MESHLODE_API meshlode_status meshlode_select_frustum(const meshlode_asset* asset, const meshlode_view* view,
                                                     const meshlode_frustum* frustum, double pixel_error,
                                                     meshlode_draw_item* items, size_t capacity, size_t* count,
                                                     meshlode_error* error);

/** What chooses with only some pages loaded: the links of an asset's DAG and the memory of a search. One per thread;
 * the asset must outlive it. */
typedef struct meshlode_selector meshlode_selector;

/** Takes all memory that selecting needs, so that no frame does. */
MESHLODE_API meshlode_status meshlode_create_selector(const meshlode_asset* asset, meshlode_selector** selector,
                                                      meshlode_error* error);
/** NULL is allowed. */
MESHLODE_API void meshlode_destroy_selector(meshlode_selector* selector);

/** A page that a view wants and that is not resident. */
typedef struct meshlode_page_request {
  uint32_t page;  /**< into meshlode_pages */
  float priority; /**< see meshlode_page_priorities */
} meshlode_page_request;

/** Chooses what to draw with the pages at hand. What is drawn covers each piece of each instance's surface exactly once
 * where the pages with terminal groups are resident, and as finely as resident pages allow; with all pages resident it
 * is what meshlode_select_frustum chooses. Takes no memory. `resident` are as many words as there are pages, divided by
 * 32 and rounded up: page p is resident if and only if bit p % 32 of word p / 32 is set; NULL: none is. `frustum` may
 * be NULL: nothing is culled. Items, capacity, count and errors as for meshlode_select_view. */
MESHLODE_API meshlode_status meshlode_select_resident(meshlode_selector* selector, const meshlode_view* view,
                                                      const meshlode_frustum* frustum, double pixel_error,
                                                      const uint32_t* resident, meshlode_draw_item* items,
                                                      size_t capacity, size_t* count, meshlode_error* error);

/** Of the last selection: wanted pages that are not resident, `*count` of them, by falling priority, then by id. A page
 * comes behind all pages that it is of no use without. Valid until the next selection. */
MESHLODE_API const meshlode_page_request* meshlode_page_requests(const meshlode_selector* selector, size_t* count);

/** Of the last selection, per page, resident or not: what is lost without it. The largest projected error in pixels of
 * its groups that do not pass and are inside the frustum, and of what depends on them; 0: this view does not want it,
 * so evict it first. MESHLODE_INFINITE_ERROR: it holds a terminal group of a mesh with an instance that is not
 * singular; keep it always. */
MESHLODE_API const float* meshlode_page_priorities(const meshlode_selector* selector, size_t* count);

/** Chooses the cut of one mesh without a camera: each group whose error is at most `max_error` (object units; infinity
 * is allowed) of a meshlode_promise is replaced. `*stored_error` (may be NULL) gets the largest error in the cut, at
 * least level0_deviation of the mesh. Clusters, capacity, count and errors as for meshlode_select_view. */
MESHLODE_API meshlode_status meshlode_select_uniform(const meshlode_asset* asset, uint32_t mesh, uint32_t promise,
                                                     double max_error, uint32_t* clusters, size_t capacity,
                                                     size_t* count, double* stored_error, meshlode_error* error);

/* --------------------------------------------------------------------------------------------- pages and clusters */

/** The page that holds a cluster; MESHLODE_NONE if there is no such cluster. */
MESHLODE_API uint32_t meshlode_page_of(const meshlode_asset* asset, uint32_t cluster);

/** Pages that hold the coarser replacements of this page's groups: `*count` of them, ascending, all of the same mesh
 * and with smaller ids. Load them first: then this page can be dropped at any time, and the renderer falls back to
 * them. */
MESHLODE_API const uint32_t* meshlode_page_dependencies(const meshlode_asset* asset, uint32_t page, uint32_t* count);

/** An order in which to load all pages: each page comes after those that it depends on, and pages with the largest
 * errors of a meshlode_promise come first, over all meshes. So what is loaded at any time is the best for its size.
 * `pages` has room for one id per page. Errors as for meshlode_tables_of. */
MESHLODE_API meshlode_status meshlode_streaming_order(const meshlode_asset* asset, uint32_t promise, uint32_t* pages,
                                                      meshlode_error* error);

/** How much a page matters, from its groups. Put into the rule of selection (docs/reference/selection.md), the sphere
 * and the largest error give at least the projected error of any group of the page, and of what depends on it, up to
 * rounding: 1e-5 of it. */
typedef struct meshlode_hint {
  float center[3];      /**< of a sphere that contains all that the page's groups draw, as meshlode_group.center */
  float radius;         /**< object units; MESHLODE_INFINITE_ERROR: all of space */
  float largest_error;  /**< of the page's groups; MESHLODE_INFINITE_ERROR: keep the page always */
  float smallest_error; /**< of the page's groups */
  uint32_t reserved[2]; /**< 0 */
} meshlode_hint;

/** The hint of a page; zeros if there is no such page. Derived from the groups, with the errors of positions: a view
 * that selects by another promise may need the page earlier. `meshlode build --page-hints` stores the same in the file,
 * for readers that do not read groups at once. */
MESHLODE_API meshlode_hint meshlode_page_hint(const meshlode_asset* asset, uint32_t page);

/** What to read before the first picture: the pages without which nothing is drawn, those that hold a terminal group of
 * a mesh with an instance that is not singular. Ranges of the file, ascending, `*count` of them. Pages with at most
 * `max_gap` bytes between them share a range; neighbours always do, so that one read gets the first pages of many small
 * meshes. A gap holds other pages, as a whole: 0 reads nothing else; up to a link's bandwidth times its latency a gap
 * costs less than another read. Ranges, capacity, count and errors as the items of meshlode_select_view. */
MESHLODE_API meshlode_status meshlode_first_ranges(const meshlode_asset* asset, uint64_t max_gap,
                                                   meshlode_range* ranges, size_t capacity, size_t* count,
                                                   meshlode_error* error);

/** Unpacks and checks a page into `out`, in its decoded, GPU-ready form: meshlode_page.bytes, aligned to 4. Errors:
 * MESHLODE_USAGE no such page, or unaligned memory; MESHLODE_INVALID with the place; MESHLODE_UNSUPPORTED for a codec
 * that is not built in; MESHLODE_TOO_SMALL. */
MESHLODE_API meshlode_status meshlode_load_page(const meshlode_asset* asset, uint32_t page, void* out, size_t capacity,
                                                meshlode_error* error);

/** Where a page lies in the file; zeros if there is no such page. */
MESHLODE_API meshlode_range meshlode_page_range(const meshlode_asset* asset, uint32_t page);

/** meshlode_load_page from stored bytes that the caller read: `size` bytes at any address, those of
 * meshlode_page_range. Both checksums and the whole page are checked. Errors: as for meshlode_load_page, and
 * MESHLODE_USAGE for another number of bytes. After MESHLODE_INVALID the content of `out` is undefined. */
MESHLODE_API meshlode_status meshlode_unpack_page(const meshlode_asset* asset, uint32_t page, const void* stored,
                                                  size_t size, void* out, size_t capacity, meshlode_error* error);

/** meshlode_load_page without a copy: checks the page and returns its bytes in the asset. Errors: as above, and
 * MESHLODE_UNSUPPORTED if the page is stored compressed, as `meshlode build` does by default: `--codec none`, there or
 * with `meshlode repack`, stores every page so that it can be viewed. */
MESHLODE_API meshlode_status meshlode_view_page(const meshlode_asset* asset, uint32_t page, const void** out,
                                                meshlode_error* error);

/** What meshlode_decode_* reads: the bytes of a page exactly as meshlode_load_page, meshlode_unpack_page or
 * meshlode_view_page of this asset returned them. They are not checked again: with other bytes the behaviour is
 * undefined. */
typedef struct meshlode_page_bytes {
  uint32_t page;     /**< id of the page */
  const void* bytes; /**< its decoded bytes */
} meshlode_page_bytes;

/** Memory of the caller for one cluster. A NULL array is not wanted. Arrays hold as many entries as the capacities say;
 * MESHLODE_MAX_CLUSTER_VERTICES and MESHLODE_MAX_CLUSTER_TRIANGLES always suffice. */
typedef struct meshlode_cluster_floats {
  uint32_t vertex_capacity;         /**< in: vertices that fit */
  uint32_t triangle_capacity;       /**< in: triangles that fit */
  float* positions;                 /**< 3 per vertex: mesh space relative to meshlode_mesh.origin */
  float* normals;                   /**< 3 per vertex, unit; untouched unless MESHLODE_NORMALS_STORED */
  float* uvs[MESHLODE_MAX_UV_SETS]; /**< 2 per vertex; set k is TEXCOORD_uv_set_source[k] of the source; untouched
                                       from uv_set_count on */
  float* colors;                    /**< 4 per vertex: linear, 0 … 1; untouched unless has_color */
  uint8_t* triangles;               /**< 3 vertex indices per triangle, counter-clockwise */
  uint32_t* triangle_materials;     /**< per triangle, an index into meshlode_materials */
  uint32_t vertex_count;            /**< out: decoded */
  uint32_t triangle_count;          /**< out: decoded */
} meshlode_cluster_floats;

/** Decodes a cluster as floats. Errors: MESHLODE_USAGE for no such cluster or another page than its own;
 * MESHLODE_TOO_SMALL with the counts stored. */
MESHLODE_API meshlode_status meshlode_decode_floats(const meshlode_asset* asset, meshlode_page_bytes page,
                                                    uint32_t cluster, meshlode_cluster_floats* out,
                                                    meshlode_error* error);

/** The integers of a cluster, exactly as stored: vertex i has values[i * channel_count + c], with the channels in the
 * order of docs/reference/format.md. */
typedef struct meshlode_cluster_integers {
  uint32_t value_capacity;      /**< in: values that fit; vertex_count * channel_count are needed */
  uint32_t triangle_capacity;   /**< in: triangles that fit */
  int32_t* values;              /**< the integers */
  uint8_t* triangles;           /**< 3 vertex indices per triangle, counter-clockwise */
  uint32_t* triangle_materials; /**< per triangle, an index into meshlode_materials */
  uint32_t vertex_count;        /**< out: decoded */
  uint32_t triangle_count;      /**< out: decoded */
  uint32_t channel_count;       /**< out: decoded */
} meshlode_cluster_integers;

/** Decodes a cluster as integers. Errors as for meshlode_decode_floats. */
MESHLODE_API meshlode_status meshlode_decode_integers(const meshlode_asset* asset, meshlode_page_bytes page,
                                                      uint32_t cluster, meshlode_cluster_integers* out,
                                                      meshlode_error* error);

#ifdef __cplusplus
}
#endif

#endif /**< MESHLODE_MESHLODE_H */
