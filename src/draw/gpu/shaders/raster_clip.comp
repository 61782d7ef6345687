// SPDX-License-Identifier: MIT
// The triangles of a cluster that are not wholly in front of the near plane and inside the guard band, as
// src/draw/raster/screen.cpp clips and src/draw/raster/coverage.cpp draws them. Few but wide: one at a time, by a
// workgroup. All its invocations together look for them: Mesa's lavapipe ends the loops of an invocation that has run 65,535
// iterations, and walking along the strips of all triangles took a third of them. So few loops are left for each pixel.
#version 460
#define GROUP_SIZE 128
#include "common.glsl"
#include "page.glsl"
#include "screen.glsl"
#include "alpha.glsl"

layout(constant_id = 0) const uint kDoubleSided = 0u;

const uint kMaxVertices = 20u;

shared int polygon_x[kMaxVertices], polygon_y[kMaxVertices];
shared uint polygon_depth[kMaxVertices];
shared uint polygon_count;
shared uint clipped[8];  // a bit for each triangle that has to be clipped

struct Polygon {
  dvec4 v[kMaxVertices];
  uint count;
};

// The correctly rounded quotient, which no device promises. \pre 0 <= a <= b, b > 0, normal
double divide_exactly(double a, double b) {
  if (!(a > 0.0lf)) return 0.0lf;
  const uvec2 words_a = unpackDouble2x32(a), words_b = unpackDouble2x32(b);
  uint64_t m = (uint64_t(words_a.y & 0xFFFFFu | 0x100000u) << 32) | uint64_t(words_a.x);
  const uint64_t n = (uint64_t(words_b.y & 0xFFFFFu | 0x100000u) << 32) | uint64_t(words_b.x);
  int exponent = exponent_of(a) - exponent_of(b);
  if (m < n) {
    m <<= 1;
    --exponent;
  }
  uint64_t q = 1ul;  // bit 53 in the end, and one bit more than a double has
  uint64_t r = m - n;
  for (int i = 0; i < 53; ++i) {
    r <<= 1;
    q <<= 1;
    if (r >= n) {
      r -= n;
      q |= 1ul;
    }
  }
  const bool is_up = (q & 1ul) != 0ul && (r != 0ul || (q & 2ul) != 0ul);
  q >>= 1;
  if (is_up) q += 1ul;
  if (q >= 0x20000000000000ul) {
    q >>= 1;
    ++exponent;
  }
  if (exponent < -1022) return 0.0lf;
  return packDouble2x32(uvec2(uint(q & 0xFFFFFFFFul), (uint(q >> 32) & 0xFFFFFu) | uint(exponent + 1023) << 20u));
}

double mix_exactly(double a, double b, double t) {
  precise double difference = b - a;
  precise double product = t * difference;
  precise double sum = a + product;
  return sum;
}

dvec4 cut_edge(dvec4 inner, dvec4 outer, double inner_distance, double outer_distance) {
  precise double whole = inner_distance - outer_distance;
  const double t = divide_exactly(inner_distance, whole);
  return dvec4(mix_exactly(inner.x, outer.x, t), mix_exactly(inner.y, outer.y, t), mix_exactly(inner.z, outer.z, t),
               mix_exactly(inner.w, outer.w, t));
}

void clip_by_plane(inout Polygon polygon, int plane) {
  Polygon o;
  o.count = 0u;
  for (uint i = 0u; i < polygon.count; ++i) {
    const dvec4 a = polygon.v[i], b = polygon.v[i + 1u == polygon.count ? 0u : i + 1u];
    const double da = plane_distance(a, plane), db = plane_distance(b, plane);
    if (da >= 0.0lf && o.count < kMaxVertices) o.v[o.count++] = a;
    if (o.count >= kMaxVertices) break;
    if (da >= 0.0lf && db < 0.0lf) o.v[o.count++] = cut_edge(a, b, da, db);
    else if (da < 0.0lf && db >= 0.0lf) o.v[o.count++] = cut_edge(b, a, db, da);
  }
  polygon = o;
}

int64_t doubled_area(uint i, uint j, uint k) {
  return int64_t(polygon_x[j] - polygon_x[i]) * int64_t(polygon_y[k] - polygon_y[i]) -
         int64_t(polygon_x[k] - polygon_x[i]) * int64_t(polygon_y[j] - polygon_y[i]);
}

void clip_triangle(uint slot, ivec3 a, ivec3 b, ivec3 c, bool is_mirrored, bool is_double_sided) {
  Polygon polygon;
  polygon.count = 3u;
  polygon.v[0] = clip_vertex(slot, a);
  polygon.v[1] = clip_vertex(slot, b);
  polygon.v[2] = clip_vertex(slot, c);
  polygon_count = 0u;
  if (!is_usable(polygon.v[0]) || !is_usable(polygon.v[1]) || !is_usable(polygon.v[2])) {
    atomicAdd(counters.not_finite, 1u);
    return;
  }
  for (int plane = 0; plane < 5 && polygon.count >= 3u; ++plane) clip_by_plane(polygon, plane);
  if (polygon.count < 3u) return;
  for (uint i = 0u; i < polygon.count; ++i) {
    if (!(polygon.v[i].w >= 1e-200lf)) return;
    const ScreenVertex s = divide(polygon.v[i]);
    polygon_x[i] = s.x;
    polygon_y[i] = s.y;
    polygon_depth[i] = s.depth;
  }
  int64_t area = 0l;
  for (uint i = 1u; i + 1u < polygon.count; ++i) area += doubled_area(0u, i, i + 1u);
  if (area == 0l || (!is_double_sided && (area > 0l) != is_mirrored)) return;
  if (area < 0l) {
    for (uint i = 1u, j = polygon.count - 1u; i < j; ++i, --j) {
      const int x = polygon_x[i], y = polygon_y[i];
      const uint depth = polygon_depth[i];
      polygon_x[i] = polygon_x[j];
      polygon_y[i] = polygon_y[j];
      polygon_depth[i] = polygon_depth[j];
      polygon_x[j] = x;
      polygon_y[j] = y;
      polygon_depth[j] = depth;
    }
  }
  polygon_count = polygon.count;
}

// The edge from i to j at a pixel centre; `bias` decides on the edge itself.
int64_t edge(uint i, uint j, int px, int py, out int bias) {
  const int dx = polygon_x[j] - polygon_x[i], dy = polygon_y[j] - polygon_y[i];
  bias = edge_bias(dx, dy);
  return int64_t(dx) * int64_t(py - polygon_y[i]) - int64_t(dy) * int64_t(px - polygon_x[i]);
}

// What triangle i of the fan adds to a pixel. Of depths the first positive triangle's counts.
void add_part(uint i, int px, int py, inout int winding, inout bool has_depth, inout uint depth) {
  int64_t area = doubled_area(0u, i, i + 1u);
  const bool is_positive = area > 0l;
  const uint b = is_positive ? i : i + 1u, c = is_positive ? i + 1u : i;
  if (!is_positive) area = -area;
  int bias_a, bias_b, bias_c;
  const int64_t ea = edge(b, c, px, py, bias_a), eb = edge(c, 0u, px, py, bias_b), ec = edge(0u, b, px, py, bias_c);
  const bool is_inside =
      area != 0l && ea + int64_t(bias_a) >= 0l && eb + int64_t(bias_b) >= 0l && ec + int64_t(bias_c) >= 0l;
  if (is_inside) winding += is_positive ? 1 : -1;
  if (is_inside && is_positive && !has_depth) {
    const uint64_t sum = uint64_t(ea) * polygon_depth[0] + uint64_t(eb) * polygon_depth[b] +
                         uint64_t(ec) * polygon_depth[c];
    const double estimate = (double(ea) * double(polygon_depth[0]) + double(eb) * double(polygon_depth[b]) +
                             double(ec) * double(polygon_depth[c])) / double(area);
    depth = divide_depth(sum, estimate, area);
    has_depth = true;
  }
}

bool is_snapped(uint slot, ClusterData data, uint vertex) {
  return snap_vertex(clip_vertex(slot, cluster_position(data, vertex))).is_snapped;
}

void draw_item(uint item) {
  const uint slot = frame.items.at[item].slot, cluster = frame.items.at[item].cluster;
  const ClusterData data =
      open_cluster(frame.meshes.at[frame.visible.at[slot].mesh], cluster);
  const bool is_mirrored = (frame.visible.at[slot].flags & kInstanceMirrored) != 0u;
  if (gl_LocalInvocationID.x < 8u) clipped[gl_LocalInvocationID.x] = 0u;
  barrier();
  for (uint t = gl_LocalInvocationID.x; t < data.triangle_count; t += uint(GROUP_SIZE)) {
    const uvec3 v = cluster_triangle(data, t);
    if (!(is_snapped(slot, data, v.x) && is_snapped(slot, data, v.y) && is_snapped(slot, data, v.z))) {
      atomicOr(clipped[t >> 5u], 1u << (t & 31u));
    }
  }
  barrier();
  for (uint t = 0u; t < data.triangle_count; ++t) {
    if ((clipped[t >> 5u] >> (t & 31u) & 1u) == 0u) continue;  // alike for all
    const uvec3 v = cluster_triangle(data, t);
    if (gl_LocalInvocationID.x == 0u) {
      polygon_count = 0u;
      const bool is_double_sided =
          kDoubleSided != 0u && frame.materials.at[cluster_material(data, t)].double_sided != 0u;
      clip_triangle(slot, cluster_position(data, v.x), cluster_position(data, v.y), cluster_position(data, v.z), is_mirrored,
                    is_double_sided);
    }
    barrier();
    if (polygon_count >= 3u) {
      BEGIN_ALPHA(slot, data, t, v);
      int low_x = polygon_x[0], high_x = low_x, low_y = polygon_y[0], high_y = low_y;
      for (uint i = 1u; i < polygon_count; ++i) {
        low_x = min(low_x, polygon_x[i]);
        high_x = max(high_x, polygon_x[i]);
        low_y = min(low_y, polygon_y[i]);
        high_y = max(high_y, polygon_y[i]);
      }
      const ivec2 columns = pixels_between(low_x, high_x, frame.width), rows = pixels_between(low_y, high_y, frame.height);
      if (columns.x <= columns.y && rows.x <= rows.y) {
        // A pixel is covered iff the signed sum over the fan is positive. What the near plane alone cuts has two triangles at
        // most: then a pixel has no loop.
        const int width = columns.y - columns.x + 1, pixels = width * (rows.y - rows.x + 1);
        const uint parts = polygon_count - 2u;
        const bool is_simple = parts <= 2u;
        for (int p = int(gl_LocalInvocationID.x); p < (is_simple ? pixels : 0); p += GROUP_SIZE) {
          const int x = columns.x + p % width, y = rows.x + p / width;
          const int px = x * kSubpixels + kSubpixels / 2, py = y * kSubpixels + kSubpixels / 2;
          int winding = 0;
          bool has_depth = false;
          uint depth = 0u;
          add_part(1u, px, py, winding, has_depth, depth);
          if (parts == 2u) add_part(2u, px, py, winding, has_depth, depth);
          if (winding > 0 AND_ALPHA(x, y)) put_pixel(x, y, pixel_value(depth, item, t));
        }
        for (int p = int(gl_LocalInvocationID.x); p < (is_simple ? 0 : pixels); p += GROUP_SIZE) {
          const int x = columns.x + p % width, y = rows.x + p / width;
          const int px = x * kSubpixels + kSubpixels / 2, py = y * kSubpixels + kSubpixels / 2;
          int winding = 0;
          bool has_depth = false;
          uint depth = 0u;
          for (uint i = 1u; i <= parts; ++i) add_part(i, px, py, winding, has_depth, depth);
          if (winding > 0 AND_ALPHA(x, y)) put_pixel(x, y, pixel_value(depth, item, t));
        }
      }
    }
    barrier();
  }
}

void main() {
  const uint index = group_index();
  if (index < counters.stages[STAGE_CLIPPED + pass].count) draw_item(frame.clipped.at[index]);
}
