// SPDX-License-Identifier: MIT
// Software rasterizer: a workgroup draws a cluster. Vertices are snapped and strips resolved once, into shared memory; a
// small triangle is one invocation's, in 32-bit integers; a larger one is everybody's, in 64-bit integers. Triangles that
// have to be clipped are left to raster_clip.comp.
#version 460
#define GROUP_SIZE 128  // a multiple of kSliceSize: few waste little on small clusters, many hide a cluster's latency
#include "common.glsl"
#include "page.glsl"
#include "screen.glsl"

// Of a cluster of this scene: little shared memory is many workgroups at once.
layout(constant_id = 5) const uint kMaxTriangles = 256u;
layout(constant_id = 6) const uint kMaxVertices = 256u;
#include "strips.glsl"
#include "alpha.glsl"

layout(constant_id = 0) const uint kDoubleSided = 0u;  // 1: some material of the scene is

const int kSmallSide = 64 * 256;  // subpixels: products of differences stay below 2^29
const int kSmallPixels = 256;     // more than this is shared by kSliceSize invocations, or by the workgroup
const int kSliceSize = 32;
const int kScanlinePixels = 6;    // from this width on a row's ends are computed

shared int shared_x[kMaxVertices], shared_y[kMaxVertices];
shared uint shared_depth[kMaxVertices];
shared uint shared_snapped[8];
shared uint large_count, has_clipped;
shared uint large[kMaxTriangles];

struct Triangle {
  ivec3 x, y;
  uvec3 depth;
};

void draw_small(Triangle t, ivec2 columns, ivec2 rows, int area, uint item, uint triangle) {
  // Edge k is opposite to vertex k: E = dx * (py - ay) - dy * (px - ax).
  const ivec3 ax = t.x.yzx, ay = t.y.yzx;
  const ivec3 dx = t.x.zxy - ax, dy = t.y.zxy - ay;
  const ivec3 bias = ivec3(edge_bias(dx.x, dy.x), edge_bias(dx.y, dy.y), edge_bias(dx.z, dy.z));
  const int px = columns.x * kSubpixels + kSubpixels / 2, py = rows.x * kSubpixels + kSubpixels / 2;
  const ivec3 start = dx * (py - ay) - dy * (px - ax);
  const ivec3 step_x = -dy * kSubpixels, step_y = dx * kSubpixels;
  const double inverse = estimate_reciprocal(double(area));
  const bool is_wide = columns.y - columns.x >= kScanlinePixels;
  const vec3 inverse_step = 1.0 / vec3(step_x);
  ivec3 row = start;
  for (int y = rows.x; y <= rows.y; ++y) {
    int first = columns.x, last = columns.y;
    if (is_wide) {
      // Where each edge crosses the row, as floats, one pixel wider than they say: the exact test comes below.
      [[unroll]] for (int k = 0; k < 3; ++k) {
        const float crossing = -float(row[k]) * inverse_step[k];
        if (step_x[k] > 0) first = max(first, columns.x + int(clamp(floor(crossing), -1.0, 128.0)) - 1);
        else if (step_x[k] < 0) last = min(last, columns.x + int(clamp(ceil(crossing), -1.0, 128.0)) + 1);
      }
    }
    ivec3 e = row + step_x * (first - columns.x);
    for (int x = first; x <= last; ++x) {
      const ivec3 biased = e + bias;
      if ((biased.x | biased.y | biased.z) >= 0 AND_ALPHA(x, y)) {
        const uint64_t sum = uint64_t(uint(e.x)) * t.depth.x + uint64_t(uint(e.y)) * t.depth.y +
                             uint64_t(uint(e.z)) * t.depth.z;
        put_pixel(x, y, pixel_value(divide_depth_small(sum, inverse, uint(area)), item, triangle));
      }
      e += step_x;
    }
    row += step_y;
  }
}

// A triangle of at most kSmallSide, by kSliceSize invocations in 32-bit integers.
void draw_medium(Triangle t, ivec2 columns, ivec2 rows, int area, uint item, uint triangle) {
  const ivec3 ax = t.x.yzx, ay = t.y.yzx;
  const ivec3 dx = t.x.zxy - ax, dy = t.y.zxy - ay;
  const ivec3 bias = ivec3(edge_bias(dx.x, dy.x), edge_bias(dx.y, dy.y), edge_bias(dx.z, dy.z));
  const int width = columns.y - columns.x + 1, pixels = width * (rows.y - rows.x + 1);
  const double inverse = estimate_reciprocal(double(area));
  for (int p = int(gl_LocalInvocationID.x) % kSliceSize; p < pixels; p += kSliceSize) {
    const int x = columns.x + p % width, y = rows.x + p / width;
    const int px = x * kSubpixels + kSubpixels / 2, py = y * kSubpixels + kSubpixels / 2;
    const ivec3 e = dx * (py - ay) - dy * (px - ax);
    const ivec3 biased = e + bias;
    if ((biased.x | biased.y | biased.z) >= 0 AND_ALPHA(x, y)) {
      const uint64_t sum = uint64_t(uint(e.x)) * t.depth.x + uint64_t(uint(e.y)) * t.depth.y +
                           uint64_t(uint(e.z)) * t.depth.z;
      put_pixel(x, y, pixel_value(divide_depth_small(sum, inverse, uint(area)), item, triangle));
    }
  }
}

void draw_large(Triangle t, ivec2 columns, ivec2 rows, int64_t area, uint item, uint triangle) {
  const ivec3 ax = t.x.yzx, ay = t.y.yzx;
  const ivec3 dx = t.x.zxy - ax, dy = t.y.zxy - ay;
  const int width = columns.y - columns.x + 1, pixels = width * (rows.y - rows.x + 1);
  const double inverse = 1.0lf / double(area);
  for (int p = int(gl_LocalInvocationID.x); p < pixels; p += GROUP_SIZE) {
    const int x = columns.x + p % width, y = rows.x + p / width;
    const int px = x * kSubpixels + kSubpixels / 2, py = y * kSubpixels + kSubpixels / 2;
    int64_t e[3];
    bool is_inside = true;
    [[unroll]] for (int k = 0; k < 3; ++k) {
      e[k] = int64_t(dx[k]) * int64_t(py - ay[k]) - int64_t(dy[k]) * int64_t(px - ax[k]);
      is_inside = is_inside && e[k] + int64_t(edge_bias(dx[k], dy[k])) >= 0l;
    }
    if (is_inside AND_ALPHA(x, y)) {
      const uint64_t sum = uint64_t(e[0]) * t.depth.x + uint64_t(e[1]) * t.depth.y + uint64_t(e[2]) * t.depth.z;
      const double estimate = (double(e[0]) * double(t.depth.x) + double(e[1]) * double(t.depth.y) +
                               double(e[2]) * double(t.depth.z)) * inverse;
      put_pixel(x, y, pixel_value(divide_depth(sum, estimate, area), item, triangle));
    }
  }
}

int64_t doubled_area(Triangle t) {
  return int64_t(t.x.y - t.x.x) * int64_t(t.y.z - t.y.x) - int64_t(t.x.z - t.x.x) * int64_t(t.y.y - t.y.x);
}

// Corners on the screen; their depths are looked up for those that are drawn alone.
Triangle load_triangle(uvec3 v) {
  Triangle t;
  t.x = ivec3(shared_x[v.x], shared_x[v.y], shared_x[v.z]);
  t.y = ivec3(shared_y[v.x], shared_y[v.y], shared_y[v.z]);
  t.depth = uvec3(0u);
  return t;
}
void load_depth(inout Triangle t, uvec3 v) { t.depth = uvec3(shared_depth[v.x], shared_depth[v.y], shared_depth[v.z]); }

// Of positive area; swapping two corners changes neither coverage nor depth.
void orient(inout Triangle t, inout int64_t area) {
  if (area < 0l) {
    t.x = t.x.xzy;
    t.y = t.y.xzy;
    t.depth = t.depth.xzy;
    area = -area;
  }
}

bool is_snapped(uint v) { return (shared_snapped[v >> 5u] >> (v & 31u) & 1u) != 0u; }

void snap_vertices(uint slot, ClusterData data, uint lane, uint lanes) {
  for (uint v = lane; v < data.vertex_count; v += lanes) {
    const ScreenVertex s = snap_vertex(clip_vertex(slot, cluster_position(data, v)));
    shared_x[v] = s.x;
    shared_y[v] = s.y;
    shared_depth[v] = s.depth;
    if (s.is_snapped) atomicOr(shared_snapped[v >> 5u], 1u << (v & 31u));
  }
}

// A small triangle is drawn here and now; a larger one is listed, and one that has to be clipped is noted.
void draw_or_list(uint item, uint slot, ClusterData data, uint i, bool is_mirrored) {
  const uvec3 v = strip_triangle(i);
  if (!is_snapped(v.x) || !is_snapped(v.y) || !is_snapped(v.z)) {
    has_clipped = 1u;
    return;
  }
  Triangle t = load_triangle(v);
  const int low_x = min(t.x.x, min(t.x.y, t.x.z)), high_x = max(t.x.x, max(t.x.y, t.x.z));
  const ivec2 columns = pixels_between(low_x, high_x, frame.width);
  if (columns.x > columns.y) return;  // most triangles of a far cluster lie between pixel centres
  const int low_y = min(t.y.x, min(t.y.y, t.y.z)), high_y = max(t.y.x, max(t.y.y, t.y.z));
  const ivec2 rows = pixels_between(low_y, high_y, frame.height);
  if (rows.x > rows.y) return;
  int64_t area = doubled_area(t);
  if (area == 0l) return;
  if ((area > 0l) != is_mirrored &&
      (kDoubleSided == 0u || frame.materials.at[cluster_material(data, i)].double_sided == 0u)) {
    return;
  }
  const bool is_small = max(high_x - low_x, high_y - low_y) <= kSmallSide &&
                        (columns.y - columns.x + 1) * (rows.y - rows.x + 1) <= kSmallPixels;
  if (is_small) {
    load_depth(t, v);
    orient(t, area);
    BEGIN_ALPHA(slot, data, i, v);
    draw_small(t, columns, rows, int(area), item, i);
  } else {
    large[atomicAdd(large_count, 1u)] = i;
  }
}

// Medium ones by slices of the workgroup side by side, then large ones by all of it.
void draw_listed(uint item, uint slot, ClusterData data, uint lane, uint lanes) {
  const uint slice = lane / uint(kSliceSize), slices = lanes / uint(kSliceSize);
  for (uint round = 0u; round < 2u; ++round) {
    for (uint i = round == 0u ? slice : 0u; i < large_count; i += round == 0u ? slices : 1u) {
      const uint triangle = large[i];
      const uvec3 v = strip_triangle(triangle);
      Triangle t = load_triangle(v);
      load_depth(t, v);
      int64_t area = doubled_area(t);
      orient(t, area);
      BEGIN_ALPHA(slot, data, triangle, v);
      const int low_x = min(t.x.x, min(t.x.y, t.x.z)), high_x = max(t.x.x, max(t.x.y, t.x.z));
      const int low_y = min(t.y.x, min(t.y.y, t.y.z)), high_y = max(t.y.x, max(t.y.y, t.y.z));
      const ivec2 columns = pixels_between(low_x, high_x, frame.width);
      const ivec2 rows = pixels_between(low_y, high_y, frame.height);
      const bool is_medium = max(high_x - low_x, high_y - low_y) <= kSmallSide;
      if (is_medium && round == 0u) draw_medium(t, columns, rows, int(area), item, triangle);
      if (!is_medium && round == 1u) draw_large(t, columns, rows, area, item, triangle);
    }
  }
}

void draw_item(uint item) {
  const uint lane = gl_LocalInvocationID.x, lanes = uint(GROUP_SIZE);
  const GpuItem entry = frame.items.at[item];
  if ((entry.slot & ITEM_IS_FAR) != 0u) return;  // in verify mode: all items are at the front
  const uint slot = entry.slot, cluster = entry.cluster;
  const ClusterData data = open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], cluster);
  if (lane < 8u) shared_snapped[lane] = 0u;
  if (lane == 0u) {
    large_count = 0u;
    has_clipped = 0u;
  }
  begin_strips(data, lane, lanes);
  barrier();
  snap_vertices(slot, data, lane, lanes);
  count_strips(data, lane, lanes);
  barrier();
  resolve_slots(data, lane, lanes);
  barrier();
  const bool is_mirrored = (frame.visible.at[slot].flags & kInstanceMirrored) != 0u;
  for (uint i = lane; i < data.triangle_count; i += lanes) draw_or_list(item, slot, data, i, is_mirrored);
  barrier();
  draw_listed(item, slot, data, lane, lanes);
  if (lane == 0u && has_clipped != 0u) {
    const uint at = atomicAdd(counters.stages[STAGE_CLIPPED + pass].count, 1u);
    cover(STAGE_CLIPPED + pass, at, 1u, 1u);
    frame.clipped.at[at] = item;  // as long as the list of items: it cannot overflow
  }
}

void main() {
  const uint item = counters.software_before[pass] + group_index();
  if (item < min(counters.stages[STAGE_SOFTWARE].count, frame.item_capacity)) draw_item(item);
}
