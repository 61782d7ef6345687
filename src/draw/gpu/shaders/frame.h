// SPDX-License-Identifier: MIT
// What the CPU and the shaders share: this text is compiled as C++ and as GLSL. Layout is `scalar`, which is C++'s own
// for these members. A pointer is a buffer's device address.
#ifndef MESHLODE_GPU_FRAME_H
#define MESHLODE_GPU_FRAME_H

#ifdef __cplusplus
#include <cstdint>

#include "run/select/metric.h"
namespace meshlode::draw {
using run::MetricView;
using uint = std::uint32_t;  // NOLINT(readability-identifier-naming): names of GLSL
struct vec4 {                // NOLINT(readability-identifier-naming)
  float x = 0.0F, y = 0.0F, z = 0.0F, w = 0.0F;
};
#define GPU_POINTER(type) std::uint64_t
#define GPU_ARRAY(type, name, count) type name[count]
#else
#include "run/select/metric.h"
#define GPU_POINTER(type) type
#define GPU_ARRAY(type, name, count) type name[count]
#endif

// Of every record below, of the order of their members, of the push constants and of the ids of specialization
// constants: what changes any of them raises it, so that who copied this text notices. docs/reference/shaders.md says
// what each version changed.
#define FRAME_LAYOUT_VERSION 1

// One mesh. Doubles first: nothing is padded.
struct GpuMesh {
  GPU_ARRAY(double, origin, 3);
  double step;   // of the grid, object units
  double reach;  // mesh_reach(), exactly as the CPU has it
  GPU_ARRAY(float, root_center, 3);
  float root_radius;  // of the BVH's root, object units relative to the origin
  uint first_node, node_count, first_group, first_cluster;
  uint channel_count;
  uint normal_mode;   // format::NormalMode
  uint normal_scale;  // |X| + |Y| + |Z| of stored normals; 0: none are
  uint uv_set_count;
  uint has_color;
  uint group_count;
  uint material;  // of every triangle; 0xFFFFFFFF: the clusters say
  // Of a mesh with one terminal group: where an instance is so far away that `coarse_error`, the largest finite error
  // of a group grown as an inner node's is, passes for the BVH's root sphere, every other group passes and that one
  // alone is open (run/select/far_instance.h).
  float coarse_error;
  uint only_root;  // that group; 0xFFFFFFFF: there is not exactly one
  uint reserved;
};

struct GpuInstance {
  GPU_ARRAY(double, transform, 12);
  double scale;
  uint mesh;
  uint flags;  // kInstanceMirrored, kInstanceSingular
};

struct GpuNode {
  GPU_ARRAY(float, center, 3);
  float radius;
  float error;
  uint first;  // child, or group where child_count is 0
  uint child_count;
  uint reserved;
};

struct GpuGroup {
  GPU_ARRAY(float, center, 3);
  float radius;
  float error;
  uint first_cluster;
  uint cluster_count;
  uint page;  // of its clusters
};

struct GpuCluster {
  GPU_ARRAY(float, center, 3);
  float radius;
  uint own_group;  // 0xFFFFFFFF at level 0
  uint page;
  uint index;      // in the page; level << 16
  uint root_word;  // in the decoded roots; of a mesh's only root cluster
};

struct GpuMaterial {
  vec4 base_color;
  uint double_sided;
  uint mask;  // of the masks; 0xFFFFFFFF: not masked
  GPU_ARRAY(uint, reserved, 2);
};

// How a mesh stores UVs.
struct GpuMeshUvs {
  GPU_ARRAY(int, log2, 4);  // step of each stored set
  uint source;              // the TEXCOORD_n that stored set k was, 8 bits each
};

// AlphaMask of draw/textures/alpha_mask.h. Doubles first.
struct GpuMask {
  GPU_ARRAY(double, rows, 6);  // UVs to texels, row_u and row_v
  uint threshold;
  uint uv_set;
  uint width, height;  // 0: every texel is opaque
  GPU_ARRAY(uint, wrap, 2);
  uint first_word;  // of its texels, four to a word
  uint reserved;
};

// A texture as resolve.comp samples it: SampledTexture of draw/textures/texture_set.h. Doubles first.
struct GpuTextureUse {
  GPU_ARRAY(double, rows, 6);  // UVs to the texture's, row_u and row_v
  uint image;                  // of the textures; 0xFFFFFFFF: not sampled
  uint uv_set;
  GPU_ARRAY(uint, wrap, 2);
};

// The textures of a material.
struct GpuSurface {
  GpuTextureUse base_color, normal;
  float normal_scale;
  uint reserved;
};

#define MAX_MIPS 15
struct GpuTexture {
  uint width, height, levels, is_srgb;
  GPU_ARRAY(uint, first, MAX_MIPS);  // of each level, a word a texel
  uint reserved;
};

#define WRAP_REPEAT 0
#define WRAP_MIRROR 1
#define WRAP_CLAMP 2

// A camera's part of draw/raster/projection.h, and what of run/select/view.cpp does not depend on the instance.
struct GpuCamera {
  GPU_ARRAY(double, eye, 3);
  GPU_ARRAY(double, right, 3);
  GPU_ARRAY(double, up, 3);
  GPU_ARRAY(double, forward, 3);
  double pixels_per_unit;
  double near_distance;
  double pixels_per_error;     // pixels_per_unit over the allowed pixels
  double minus_inverse_range;  // orthographic: z = minus_inverse_range * distance + far_over_range
  double far_over_range;
  uint is_orthographic;
  uint any_error_fails;  // the allowed pixels are not above 0
};

// One instance that passed its tests.
struct GpuVisible {
  GPU_ARRAY(double, clip, 16);  // rows x y z w of GridToClip: x y z constant
  MetricView view;
  vec4 cull_x, cull_y, cull_z, cull_w;  // the same rows for object units, for culling alone
  vec4 plane_norm;                      // gradient lengths of the left, right, top and bottom planes
  vec4 row_norm;                        // of x y z w
  vec4 last_x, last_y, last_z, last_w;  // with the camera of the frame before
  vec4 last_norm;
  uint instance, mesh, flags, reserved;
};

// A cluster that is drawn.
struct GpuItem {
  uint slot;     // of the visible instances, and ITEM_IS_… marks
  uint cluster;  // of the scene
  uint view;     // whose picture it is drawn in: 0 where there is one
};

// A list's length and the arguments of the dispatch that works on it.
struct GpuStage {
  uint count;
  uint x, y, z;
};

#define STAGE_INSTANCES 0  // of the scene, or those that are retried
#define STAGE_SLOTS 1      // visible instances
#define STAGE_RETRY_INSTANCES 2
#define STAGE_RETRY_CLUSTERS 3
#define STAGE_GROUPS 4    // + pass
#define STAGE_SOFTWARE 6  // + pass: .count of pass 0 counts both
#define STAGE_HARDWARE 8  // + pass, as above; x y z are those of a mesh draw. Without hardware raster: far roots
#define STAGE_CLIPPED 10  // + pass
#define STAGE_DRAW 12     // + pass: VkDrawIndirectCommand
#define STAGE_QUEUE 16    // + kMaxDepth * pass + depth
#define MAX_DEPTH 24
#define STAGE_COUNT (STAGE_QUEUE + 2 * MAX_DEPTH)

#define OVERFLOW_SLOTS 1
#define OVERFLOW_QUEUE 2
#define OVERFLOW_GROUPS 4
#define OVERFLOW_CLUSTERS 8
#define OVERFLOW_RETRY 16

struct GpuCounters {
  GPU_ARRAY(GpuStage, stages, STAGE_COUNT);
  uint overflow;
  GPU_ARRAY(uint, software_before, 2);  // [pass]: items of earlier passes
  GPU_ARRAY(uint, hardware_before, 2);
  uint not_finite;
  // Of the persistent traversal, [pass]: entries taken; entries added behind those that the list began with; entries
  // added less entries done.
  GPU_ARRAY(uint, taken, 2);
  GPU_ARRAY(uint, added, 2);
  GPU_ARRAY(int, balance, 2);
  uint pyramid_tiles;  // done: whose is the last one builds the levels above all tiles
};

// What resolve.comp shows; the first four are View of draw/raster/raster.h.
#define VIEW_SHADED 0
#define VIEW_CLUSTERS 1
#define VIEW_TRIANGLES 2
#define VIEW_LEVELS 3
#define VIEW_NORMALS 4
#define VIEW_PAGES 5
#define VIEW_OVERDRAW 6  // blue once, red 16 times and more
#define VIEW_PATHS 7     // blue software, green far roots, red hardware
#define VIEW_OCCLUDED 8  // orange: last frame's depth had hidden it, the second pass brought it back

#define MAX_PYRAMID 15
// Of an item's slot: drawn by raster_far.comp, and then whether the instance is mirrored.
#define ITEM_IS_FAR 0x80000000u
#define ITEM_IS_MIRRORED 0x40000000u
#define ITEM_SLOT 0x3FFFFFFFu
#define FAR_PIXELS 16.0  // wider clusters are raster.comp's

// Payload of a pixel: (depth << 32) | ~(item << 8 | triangle), so that atomicMax keeps the nearest, then the lowest
// key.
#define MAX_ITEMS 16777215

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer MeshArray {
  GpuMesh at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer InstanceArray {
  GpuInstance at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer NodeArray {
  GpuNode at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer GroupArray {
  GpuGroup at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer ClusterArray {
  GpuCluster at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer MaterialArray {
  GpuMaterial at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer MeshUvsArray {
  GpuMeshUvs at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer MaskArray {
  GpuMask at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer PageWords {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer SurfaceArray {
  GpuSurface at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer TextureArray {
  GpuTexture at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer VisibleArray {
  GpuVisible at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer ItemArray {
  GpuItem at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PairArray {
  uvec2 at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer WordArray {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) coherent buffer PyramidArray {
  uint at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer PixelArray {
  uint64_t at[];
};
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer CounterBlock {
  GpuCounters all;
};
#endif

struct GpuFrame {
  GpuCamera camera;
  GpuCamera last;  // of the frame before: whose depth the pyramid holds
  GPU_POINTER(MeshArray) meshes;
  GPU_POINTER(InstanceArray) instances;
  GPU_POINTER(NodeArray) nodes;
  GPU_POINTER(GroupArray) groups;
  GPU_POINTER(ClusterArray) clusters;
  GPU_POINTER(MaterialArray) materials;
  GPU_POINTER(PageWords) pages;
  GPU_POINTER(PageWords) page_words;  // per page: where it begins, in words from the start of the pages
  GPU_POINTER(PageWords) ready;       // per group a bit: its page is resident, and those of all coarser groups
  GPU_POINTER(WordArray) priorities;  // per page, written by the frame: bits of a float (resident.glsl)
  GPU_POINTER(WordArray) roots;       // decoded: roots.comp
  GPU_POINTER(VisibleArray) visible;
  GPU_POINTER(PairArray) queue;           // parts of queue_capacity: (slot, node)
  GPU_POINTER(PairArray) open_groups;     // (slot, group)
  GPU_POINTER(ItemArray) items;           // software from the front; from the back hardware or far ones
  GPU_POINTER(PairArray) retry_nodes;     // (slot, node)
  GPU_POINTER(PairArray) retry_clusters;  // (slot, cluster)
  GPU_POINTER(WordArray) retry_instances;
  GPU_POINTER(WordArray) clipped;  // items with a triangle that has to be clipped
  GPU_POINTER(PixelArray) pixels;
  GPU_POINTER(PyramidArray) pyramid;
  GPU_POINTER(WordArray) overdraw;  // how often each pixel was drawn, where it is counted
  GPU_POINTER(WordArray) colors;    // RGBA, 8 bits each: resolve.comp
  GPU_POINTER(CounterBlock) counters;
  GPU_POINTER(MeshUvsArray) mesh_uvs;
  GPU_POINTER(MaskArray) masks;
  GPU_POINTER(PageWords) mask_texels;
  GPU_POINTER(SurfaceArray) surfaces;  // where textures were uploaded
  GPU_POINTER(TextureArray) textures;
  GPU_POINTER(PageWords) texels;
  uint width, height;
  uint instance_count;
  uint slot_capacity, queue_capacity, group_capacity, item_capacity, retry_capacity;
  uint pyramid_levels;  // levels 1 … pyramid_levels are stored
  GPU_ARRAY(uint, pyramid_offset, MAX_PYRAMID + 1);
  float hardware_pixels;  // a cluster wider than this goes to the hardware; 0: never
};

#ifdef __cplusplus
static_assert(sizeof(GpuMesh) == 112 && sizeof(GpuInstance) == 112 && sizeof(GpuNode) == 32 && sizeof(GpuGroup) == 32);
static_assert(sizeof(GpuCluster) == 32 && sizeof(GpuMaterial) == 32 && sizeof(GpuCamera) == 144);
static_assert(sizeof(GpuMeshUvs) == 20 && sizeof(GpuMask) == 80);
static_assert(sizeof(GpuTextureUse) == 64 && sizeof(GpuSurface) == 136 && sizeof(GpuTexture) == 80);
static_assert(sizeof(GpuVisible) == 384 && sizeof(GpuItem) == 12 && sizeof(GpuStage) == 16);

}  // namespace meshlode::draw
#else
layout(buffer_reference, scalar, buffer_reference_align = 16) readonly buffer FrameBlock {
  GpuFrame all;
};
#endif

#undef GPU_POINTER
#undef GPU_ARRAY
#endif  // MESHLODE_GPU_FRAME_H
