// SPDX-License-Identifier: GPL-3.0-or-later
// What SourceTree hides: the source, and the tree over it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/unset_vector.h"
#include "builder/deviation/deviation.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

struct SourceTree::Impl {
  std::span<const Vec3d> positions;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> vertex_of;     ///< per position: the first in the same place; empty: all are apart
  SurfaceTree tree;                         ///< over positions and triangles
  std::vector<std::uint32_t> first_corner;  ///< per vertex and one more: into triangle_of_corner
  UnsetVector<std::uint32_t> triangle_of_corner;
  UnsetVector<TreeSlot> place;  ///< per triangle: its place in the tree

  /// Fills vertex_of and the lists of corners, from positions and triangles.
  void list_corners();
  /// Whether very many triangles meet in some vertex. \pre corners are listed
  [[nodiscard]] bool has_hub() const;
  [[nodiscard]] TreeSlot place_of(std::uint32_t triangle) const { return place[triangle]; }
  [[nodiscard]] TriangleCorners corners(std::uint32_t triangle) const {
    const auto& t = triangles[triangle];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
  /// Corners by vertex: seams of attributes do not stop a search.
  [[nodiscard]] std::array<std::uint32_t, 3> vertices(std::uint32_t triangle) const {
    const auto& t = triangles[triangle];
    return vertex_of.empty() ? t : std::array{vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]};
  }
  [[nodiscard]] std::span<const std::uint32_t> triangles_around(std::uint32_t vertex) const {
    return std::span(triangle_of_corner).subspan(first_corner[vertex], first_corner[vertex + 1] - first_corner[vertex]);
  }
};

}  // namespace meshlode::builder
