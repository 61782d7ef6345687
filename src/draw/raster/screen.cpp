// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/screen.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace meshlode::draw {

namespace {

constexpr double kLargest = 1e150;  ///< products of two such numbers are finite

bool is_usable(const ClipVertex& v) {
  return std::abs(v.x) <= kLargest && std::abs(v.y) <= kLargest && std::abs(v.z) <= kLargest &&
         std::abs(v.w) <= kLargest;
}

constexpr int kPlaneCount = 5;

/// Signed distance to a clipping plane, not negative inside. The near plane is first, so that w > 0 for the others.
double plane_distance(const ClipVertex& v, int plane) {
  switch (plane) {
    case 0: return v.w - v.z;
    case 1: return kGuardPixels * v.w - v.x;
    case 2: return kGuardPixels * v.w + v.x;
    case 3: return kGuardPixels * v.w - v.y;
    default: return kGuardPixels * v.w + v.y;
  }
}

/// Where the edge from `inner` to `outer` meets the plane: always computed from the inner end, so that both triangles
/// of the edge get the same bits.
ClipVertex cut_edge(const ClipVertex& inner, const ClipVertex& outer, double inner_distance, double outer_distance) {
  const double t = inner_distance / (inner_distance - outer_distance);
  return {inner.x + t * (outer.x - inner.x), inner.y + t * (outer.y - inner.y), inner.z + t * (outer.z - inner.z),
          inner.w + t * (outer.w - inner.w)};
}

struct ClipPolygon {
  std::array<ClipVertex, ScreenPolygon::kMaxVertices> v;
  std::size_t count = 0;
};

/// Sutherland and Hodgman, 1974.
ClipPolygon clip_by_plane(const ClipPolygon& in, int plane) {
  ClipPolygon out;
  for (std::size_t i = 0; i < in.count; ++i) {
    const ClipVertex& a = in.v[i];
    const ClipVertex& b = in.v[(i + 1) % in.count];
    const double da = plane_distance(a, plane), db = plane_distance(b, plane);
    if (da >= 0.0) out.v[out.count++] = a;
    if (da >= 0.0 && db < 0.0) {
      out.v[out.count++] = cut_edge(a, b, da, db);
    } else if (da < 0.0 && db >= 0.0) {
      out.v[out.count++] = cut_edge(b, a, db, da);
    }
  }
  return out;
}

/// 2^exponent. \pre -1022 <= exponent <= 1023
double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

std::int64_t floor_divide(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t quotient = numerator / denominator;
  return quotient - (numerator % denominator < 0 ? 1 : 0);
}

/// The perspective divide. The vertex is scaled by a power of two so that w is an integer of 31 bits; from there on the
/// quotients are exact integer divisions. Clipping edges of wildly different lengths may end a little outside the guard
/// band; such a vertex is moved onto it. \pre w is normal and positive, and not above kLargest
ScreenVertex divide(const ClipVertex& v, ImageSize size) {
  const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(v.w) >> 52) - 1023;  // w in [2^e, 2^(e + 1))
  const double scale = power_of_two(30 - exponent);
  const auto w = static_cast<std::int64_t>(std::floor(v.w * scale + 0.5));  // 2^30 … 2^31
  const auto pixel = [&](double c, std::uint32_t side) {
    const double inside = std::clamp(c, -kGuardPixels * v.w, kGuardPixels * v.w);
    const auto scaled = static_cast<std::int64_t>(std::floor(inside * scale * kSubpixels + 0.5));  // below 2^60
    const std::int64_t quotient = floor_divide(2 * scaled + w, 2 * w);                             // to the nearest
    return static_cast<std::int32_t>(quotient + static_cast<std::int64_t>(side) * (kSubpixels / 2));
  };
  const double z = std::clamp(v.z * scale, 0.0, v.w * scale);
  const auto depth = static_cast<std::uint64_t>(z * 4294967296.0) / static_cast<std::uint64_t>(w);
  return {pixel(v.x, size.width), pixel(v.y, size.height),
          static_cast<std::uint32_t>(std::min<std::uint64_t>(depth, 0xFFFFFFFFu))};
}

bool is_culled(std::int64_t area, Culling culling) {
  return area == 0 || (area > 0 && culling == Culling::kClockwise) ||
         (area < 0 && culling == Culling::kCounterClockwise);
}

void add_clipped(const ClipPolygon& clipped, Culling culling, TriangleKey key, ImageSize size, ScreenSoup& out) {
  if (clipped.count < 3) return;
  ScreenPolygon polygon;
  polygon.key = key;
  for (std::size_t i = 0; i < clipped.count; ++i) {
    if (!(clipped.v[i].w >= 1e-200)) return;  // cannot be: the near plane keeps w positive
    polygon.v[polygon.count++] = divide(clipped.v[i], size);
  }
  std::int64_t area = 0;
  for (std::uint32_t i = 1; i + 1 < polygon.count; ++i)
    area += doubled_area(polygon.v[0], polygon.v[i], polygon.v[i + 1]);
  if (is_culled(area, culling)) return;
  if (area < 0) std::reverse(polygon.v.begin() + 1, polygon.v.begin() + polygon.count);
  out.polygons.push_back(polygon);
}

}  // namespace

std::int64_t doubled_area(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c) {
  return std::int64_t{b.x - a.x} * (c.y - a.y) - std::int64_t{c.x - a.x} * (b.y - a.y);
}

PixelRange pixels_between(std::int32_t low, std::int32_t high, std::uint32_t count) {
  // Centre of pixel p: 256 p + 128. C++20 shifts round towards minus infinity.
  const std::int32_t first = (low - kSubpixels / 2 + kSubpixels - 1) >> kSubpixelBits;
  const std::int32_t last = (high - kSubpixels / 2) >> kSubpixelBits;
  return {std::max(first, 0), std::min(last, static_cast<std::int32_t>(count) - 1)};
}

std::optional<ScreenVertex> snap_vertex(const ClipVertex& v, ImageSize size) {
  if (!is_usable(v)) return std::nullopt;
  for (int plane = 0; plane < kPlaneCount; ++plane) {
    if (!(plane_distance(v, plane) >= 0.0)) return std::nullopt;
  }
  if (!(v.w >= 1e-200)) return std::nullopt;
  return divide(v, size);
}

void add_snapped(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c, Culling culling, TriangleKey key,
                 ImageSize size, ScreenSoup& out) {
  if (pixels_between(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), size.width).is_empty()) return;
  if (pixels_between(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), size.height).is_empty()) return;
  const std::int64_t area = doubled_area(a, b, c);
  if (is_culled(area, culling)) return;
  if (area > 0) {
    out.triangles.push_back({{a, b, c}, key});
  } else {
    out.triangles.push_back({{a, c, b}, key});
  }
}

void add_triangle(const std::array<ClipVertex, 3>& v, Culling culling, TriangleKey key, ImageSize size,
                  ScreenSoup& out) {
  const auto a = snap_vertex(v[0], size), b = snap_vertex(v[1], size), c = snap_vertex(v[2], size);
  if (a && b && c) {
    add_snapped(*a, *b, *c, culling, key, size, out);
    return;
  }
  if (!is_usable(v[0]) || !is_usable(v[1]) || !is_usable(v[2])) {
    ++out.not_finite;
    return;
  }
  ClipPolygon polygon;
  std::copy(v.begin(), v.end(), polygon.v.begin());
  polygon.count = 3;
  for (int plane = 0; plane < kPlaneCount && polygon.count >= 3; ++plane) polygon = clip_by_plane(polygon, plane);
  add_clipped(polygon, culling, key, size, out);
}

}  // namespace meshlode::draw
