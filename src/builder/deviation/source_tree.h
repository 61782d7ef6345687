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
  std::vector<std::uint32_t> vertex_of;  ///< per position: the first in the same place; empty: all are apart
  SurfaceTree tree;                      ///< over positions and triangles
  UnsetVector<TreeSlot> place;           ///< per triangle: its place in the tree

  /// Whether very many triangles meet in some vertex. \pre vertex_of is filled
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
};

}  // namespace meshlode::builder
