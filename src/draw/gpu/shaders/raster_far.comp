// SPDX-License-Identifier: MIT
// Software rasterizer for root clusters of a few pixels, of which large scenes have most: the same integers as raster.comp
// (I9), for less. The cluster is decoded already (roots.comp); it is known to be in front of the near plane, inside the
// guard band and small, so nothing is clipped and all coordinates are small; the perspective divide stays in doubles, whose
// integers are exact below 2^53. kFarLanes invocations draw a cluster, several clusters share a workgroup, and triangles that
// reach a pixel centre are gathered before they are drawn: few do.
#version 460
#define GROUP_SIZE 128
#include "common.glsl"
#include "screen.glsl"
#ifdef ALPHA_MASK
#include "page.glsl"
#endif
#include "alpha.glsl"

layout(constant_id = 0) const uint kDoubleSided = 0u;
// Of the scene's roots: little shared memory is many workgroups at once.
layout(constant_id = 4) const uint kMaxRootVertices = 256u;
layout(constant_id = 7) const uint kMaxRootTriangles = 256u;

shared ivec2 far_xy[kFarPerGroup * kMaxRootVertices];
shared uint far_depth[kFarPerGroup * kMaxRootVertices];
shared uint far_drawn[kFarPerGroup * kMaxRootTriangles];  // corners, 8 bits each, and the triangle
shared uint far_count[kFarPerGroup];

// floor(n / d) for an integer n, |n| < 2^63. \pre the quotient fits, inverse = estimate_reciprocal(d)
int quotient(double n, uint d, double inverse) {
  int q = int(clamp(floor(n * inverse), -2147483647.0lf, 2147483646.0lf));
  const int64_t r = int64_t(n) - int64_t(q) * int64_t(d);
  return q + (r < 0l ? -1 : r >= int64_t(d) ? 1 : 0);
}

int far_axis(double c, double scale, double w, uint w_integer, double inverse, uint side) {
  precise double scaled = c * scale;
  precise double shifted = scaled + 0.5lf;
  // floor((2 s + w) / (2 w)) = floor(floor((2 s + w) / 2) / w)
  return quotient(floor(shifted) + floor(0.5lf * w), w_integer, inverse) + int(side) * (kSubpixels / 2);
}

// divide() of screen.glsl. \pre 1e-200 <= v.w <= 1e150, |x|, |y| <= 2^13 w
void snap_far(dvec4 v, out ivec2 xy, out uint depth) {
  const double scale = power_of_two(30 - exponent_of(v.w));
  precise double w_scaled = v.w * scale;
  precise double w_shifted = w_scaled + 0.5lf;
  const double w = floor(w_shifted);
  const uint w_integer = uint(w);  // 2^30 … 2^31
  const double inverse = estimate_reciprocal(w);
  xy.x = far_axis(v.x, scale * 256.0lf, w, w_integer, inverse, frame.width);
  xy.y = far_axis(v.y, scale * 256.0lf, w, w_integer, inverse, frame.height);
  precise double z = v.z * scale;
  z = z < 0.0lf ? 0.0lf : (z > w_scaled ? w_scaled : z);
  precise double z32 = z * 4294967296.0lf;
  const int64_t numerator = int64_t(z32);
  uint q = uint(min(floor(z32 * inverse), 4294967295.0lf));
  const int64_t r = numerator - int64_t(uint64_t(q) * uint64_t(w_integer));
  if (r < 0l) --q;
  else if (r >= int64_t(w_integer) && q != 0xFFFFFFFFu) ++q;
  depth = q;
}

void draw_box(ivec3 x, ivec3 y, uvec3 depth, uint item, uint triangle) {
  int area = (x.y - x.x) * (y.z - y.x) - (x.z - x.x) * (y.y - y.x);
  if (area < 0) {
    x = x.xzy;
    y = y.xzy;
    depth = depth.xzy;
    area = -area;
  }
  const ivec3 ax = x.yzx, ay = y.yzx;
  const ivec3 dx = x.zxy - ax, dy = y.zxy - ay;
  const ivec3 bias = ivec3(edge_bias(dx.x, dy.x), edge_bias(dx.y, dy.y), edge_bias(dx.z, dy.z));
  const ivec2 columns = pixels_between(min(x.x, min(x.y, x.z)), max(x.x, max(x.y, x.z)), frame.width);
  const ivec2 rows = pixels_between(min(y.x, min(y.y, y.z)), max(y.x, max(y.y, y.z)), frame.height);
  const double inverse = estimate_reciprocal(double(area));
  ivec3 row = dx * (rows.x * kSubpixels + kSubpixels / 2 - ay) - dy * (columns.x * kSubpixels + kSubpixels / 2 - ax);
  for (int py = rows.x; py <= rows.y; ++py) {
    ivec3 e = row;
    for (int px = columns.x; px <= columns.y; ++px) {
      const ivec3 biased = e + bias;
      if ((biased.x | biased.y | biased.z) >= 0 AND_ALPHA(px, py)) {
        const uint64_t sum = uint64_t(uint(e.x)) * depth.x + uint64_t(uint(e.y)) * depth.y + uint64_t(uint(e.z)) * depth.z;
        put_pixel(px, py, pixel_value(divide_depth_small(sum, inverse, uint(area)), item, triangle));
      }
      e -= dy * kSubpixels;
    }
    row += dx * kSubpixels;
  }
}

void main() {
  const uint slice = gl_LocalInvocationID.x / kFarLanes, lane = gl_LocalInvocationID.x % kFarLanes;
  const uint vertices = slice * kMaxRootVertices, triangles = slice * kMaxRootTriangles;
  // In verify mode (a = 1) all items are in order at the front, and those of this pass are marked.
  const uint index = group_index() * kFarPerGroup + slice + (a == 1u ? 0u : counters.hardware_before[pass]);
  bool is_there = index < (a == 1u ? counters.stages[STAGE_SOFTWARE].count : min(counters.stages[STAGE_HARDWARE].count, frame.item_capacity));
  const uint item = a == 1u ? index : frame.item_capacity - 1u - index;
  GpuItem entry = item_of(0u, 0u);
  if (is_there) entry = frame.items.at[item];
  is_there = is_there && (entry.slot & ITEM_IS_FAR) != 0u;
  const uint slot = entry.slot & ITEM_SLOT;
  const bool is_mirrored = (entry.slot & ITEM_IS_MIRRORED) != 0u;
  uint word = 0u, vertex_count = 0u, triangle_count = 0u;
  if (is_there) {
    word = frame.clusters.at[entry.cluster].root_word;
    const uint head = frame.roots.at[word++];
    vertex_count = head & 0xFFFFu;
    triangle_count = head >> 16u;
  }
  if (lane == 0u) far_count[slice] = 0u;
  for (uint v = lane; v < vertex_count; v += kFarLanes) {
    const uint at = word + 3u * v;
    const dvec3 p = dvec3(ivec3(frame.roots.at[at], frame.roots.at[at + 1u], frame.roots.at[at + 2u]));
    // The rows that are constant: a sum of zeros and the constant is the constant.
    dvec4 clip = dvec4(clip_row(slot, 0u, p), clip_row(slot, 1u, p), frame.visible.at[slot].clip[11], frame.visible.at[slot].clip[15]);
    if (frame.camera.is_orthographic != 0u) clip.z = clip_row(slot, 2u, p);
    else clip.w = clip_row(slot, 3u, p);
    if (!(clip.w >= 1e-200lf && clip.w <= 1e150lf)) clip = dvec4(0.0lf, 0.0lf, 0.0lf, 1.0lf);  // a damaged file's
    snap_far(clip, far_xy[vertices + v], far_depth[vertices + v]);
  }
  barrier();
  for (uint t = lane; t < triangle_count; t += kFarLanes) {
    const uint corners = frame.roots.at[word + 3u * vertex_count + t];
    const ivec2 v0 = far_xy[vertices + (corners & 255u)], v1 = far_xy[vertices + (corners >> 8u & 255u)],
                v2 = far_xy[vertices + (corners >> 16u & 255u)];
    const ivec2 low = min(v0, min(v1, v2)), high = max(v0, max(v1, v2));
    const ivec2 columns = pixels_between(low.x, high.x, frame.width), rows = pixels_between(low.y, high.y, frame.height);
    const int area = (v1.x - v0.x) * (v2.y - v0.y) - (v2.x - v0.x) * (v1.y - v0.y);
    bool is_drawn = columns.x <= columns.y && rows.x <= rows.y && area != 0;
    if ((area > 0) != is_mirrored) is_drawn = is_drawn && kDoubleSided != 0u && (corners >> 24u & 1u) != 0u;
    if (is_drawn) far_drawn[triangles + atomicAdd(far_count[slice], 1u)] = (corners & 0xFFFFFFu) | t << 24u;
  }
  barrier();
  for (uint i = lane; i < far_count[slice]; i += kFarLanes) {
    const uint corners = far_drawn[triangles + i];
    const uvec3 v = uvec3(corners, corners >> 8u, corners >> 16u) & 255u;
    const ivec2 v0 = far_xy[vertices + v.x], v1 = far_xy[vertices + v.y], v2 = far_xy[vertices + v.z];
    BEGIN_ALPHA(slot, open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], entry.cluster), corners >> 24u, v);
    draw_box(ivec3(v0.x, v1.x, v2.x), ivec3(v0.y, v1.y, v2.y),
             uvec3(far_depth[vertices + v.x], far_depth[vertices + v.y], far_depth[vertices + v.z]), item, corners >> 24u);
  }
}
