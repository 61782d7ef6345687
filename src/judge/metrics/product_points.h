// SPDX-License-Identifier: GPL-3.0-or-later
// Corners and points of a shaded surface in the product space (product_distance.h). Internal to the room.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "judge/metrics/area_samples.h"
#include "judge/metrics/product_scales.h"
#include "judge/metrics/product_tree.h"
#include "judge/metrics/shaded_surface.h"

namespace meshlode::judge::product {

constexpr std::size_t kFew = 8, kMany = 16;  // coordinates: multiples of a vector's, so that loops over them are short
static_assert(3 + 2 * scene::kMaxUvSets + 3 <= kMany);

/// Which UV sets count, in the order of their coordinates.
struct Coordinates {
  std::vector<std::size_t> uv_sets;
  ProductLayout layout;
};

inline Coordinates coordinates_of(const ProductScales& scales) {
  Coordinates out;
  for (std::size_t n = 0; n < scales.uv.size(); ++n) {
    if (scales.uv[n].x > 0.0 && scales.uv[n].y > 0.0) out.uv_sets.push_back(n);
  }
  out.layout.uv_sets = static_cast<std::uint32_t>(out.uv_sets.size());
  out.layout.has_normal = scales.normal > 0.0;
  return out;
}

template <std::size_t N>
std::vector<ProductPoint<N>> vertices_of(const ShadedSurface& s, const ProductScales& scales, const Coordinates& at) {
  std::vector<ProductPoint<N>> out(s.surface.positions.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    ProductPoint<N>& point = out[v];
    for (int k = 0; k < 3; ++k) point.x[static_cast<std::size_t>(k)] = s.surface.positions[v][k];
    for (std::size_t k = 0; k < at.uv_sets.size(); ++k) {
      const std::size_t set = at.uv_sets[k];
      if (s.uvs[set].empty() || !std::isfinite(s.uvs[set][v].x) || !std::isfinite(s.uvs[set][v].y)) continue;
      point.x[3 + 2 * k] = scales.uv[set].x * double{s.uvs[set][v].x};
      point.x[4 + 2 * k] = scales.uv[set].y * double{s.uvs[set][v].y};
      point.known |= 1U << k;
    }
    if (!at.layout.has_normal || s.normals.empty()) continue;
    const Vec3d n(s.normals[v]);
    const double length = glm::length(n);
    if (!std::isfinite(length) || !(length > 0.0)) continue;
    put_normal<N>(point.x, at.layout.normal_at(), n * (scales.normal / length));
    point.known |= 1U << at.layout.uv_sets;
  }
  return out;
}

/// The point of a triangle at the weights of its second and third corner.
template <std::size_t N>
ProductPoint<N> point_at(const std::vector<ProductPoint<N>>& vertices, const std::array<std::uint32_t, 3>& triangle,
                         const SurfacePoint& at, const ProductLayout& layout) {
  ProductPoint<N> out;
  out.known = layout.all_known();
  Corners<N> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    out.known &= vertices[triangle[k]].known;
    corners[k] = vertices[triangle[k]].x;
  }
  for (std::size_t k = 0; k < N; ++k) {
    out.x[k] = corners[0][k] + at.u * (corners[1][k] - corners[0][k]) + at.v * (corners[2][k] - corners[0][k]);
  }
  for (std::uint32_t k = 0; k < layout.uv_sets; ++k) {
    if ((out.known >> k & 1U) == 0) out.x[3 + 2 * k] = out.x[4 + 2 * k] = 0.0;
  }
  if (layout.has_normal && (out.known >> layout.uv_sets & 1U) == 0) {
    put_normal<N>(out.x, layout.normal_at(), Vec3d(0.0));
  }
  return out;
}

}  // namespace meshlode::judge::product
