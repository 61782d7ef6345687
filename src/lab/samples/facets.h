// SPDX-License-Identifier: GPL-3.0-or-later
// Flat facets with normals of their own, and points between two corners that have the same bits whichever facet asks.
#pragma once

#include <cmath>
#include <cstdint>

#include "lab/samples/cube_grid.h"
#include "scene/scene.h"

namespace meshlode::lab {

[[nodiscard]] inline Vec3d unit(const Vec3d& v) {
  return v / std::sqrt(glm::dot(v, v));
}

/// A card that a texture fills: from the middle of its foot, `half` of its width to either side and all the way `up`.
inline void add_card(scene::Primitive& out, const Vec3d& foot, const Vec3d& half, const Vec3d& up,
                     const Vec3f& normal) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  out.positions.insert(out.positions.end(), {foot - half, foot + half, foot + half + up, foot - half + up});
  out.normals.insert(out.normals.end(), 4, normal);
  out.uvs[0].insert(out.uvs[0].end(), {{0.0F, 1.0F}, {1.0F, 1.0F}, {1.0F, 0.0F}, {0.0F, 0.0F}});
  add_quad(out.indices, first, first + 1, first + 2, first + 3);
}

/// Adds flat facets that have vertices and a normal of their own.
struct FacetBuilder {
  scene::Primitive& out;

  /// A flat patch a b c d (counter-clockwise) of u × v cells.
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, std::uint32_t u, std::uint32_t v) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    const Vec3f normal(unit(glm::cross(b - a, d - a)));
    for (std::uint32_t j = 0; j <= v; ++j) {
      for (std::uint32_t i = 0; i <= u; ++i) {
        out.positions.push_back(mix(mix(a, b, i, u), mix(d, c, i, u), j, v));
        out.normals.push_back(normal);
      }
    }
    for (std::uint32_t j = 0; j < v; ++j) {
      for (std::uint32_t i = 0; i < u; ++i) {
        const std::uint32_t q = first + j * (u + 1) + i;
        add_quad(out.indices, q, q + 1, q + u + 2, q + u + 1);
      }
    }
  }

  /// A flat triangle a b c with `n` segments along each side.
  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, std::uint32_t n) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    const Vec3f normal(unit(glm::cross(b - a, c - a)));
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i + j <= n; ++i) {
        // Row j runs from side a-c to side b-c; the rows' ends and row 0 are the points that the neighbours have.
        out.positions.push_back(j == n ? c : mix(mix(a, c, j, n), mix(b, c, j, n), i, n - j));
        out.normals.push_back(normal);
      }
    }
    const auto id = [&](std::uint32_t i, std::uint32_t j) { return first + j * (n + 1) - j * (j - 1) / 2 + i; };
    for (std::uint32_t j = 0; j < n; ++j) {
      for (std::uint32_t i = 0; i + j < n; ++i) {
        out.indices.insert(out.indices.end(), {id(i, j), id(i + 1, j), id(i, j + 1)});
        if (i + j + 1 < n) out.indices.insert(out.indices.end(), {id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
      }
    }
  }

  /// Point i of n between a and b: exact at both ends and the same bits counted from either, so that facets meet
  /// without a gap.
  static Vec3d mix(const Vec3d& a, const Vec3d& b, std::uint32_t i, std::uint32_t n) {
    if (i == 0) return a;
    if (i == n) return b;
    return (a * static_cast<double>(n - i) + b * static_cast<double>(i)) / static_cast<double>(n);
  }
};

}  // namespace meshlode::lab
