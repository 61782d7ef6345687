// SPDX-License-Identifier: GPL-3.0-or-later
// What SourceTree hides: its own copy of the source, and the tree over it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "build/deviation/deviation.h"
#include "build/deviation/surface_tree.h"

namespace meshlode::build {

struct SourceTree::Impl {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  SurfaceTree tree;                         ///< over the two above
  std::vector<std::uint32_t> first_corner;  ///< per position and one more: into triangle_of_corner
  std::vector<std::uint32_t> triangle_of_corner;
  std::vector<TreeSlot> place;  ///< per triangle: its place in the tree

  [[nodiscard]] TreeSlot place_of(std::uint32_t triangle) const { return place[triangle]; }
  [[nodiscard]] TriangleCorners corners(std::uint32_t triangle) const {
    const auto& t = triangles[triangle];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
  [[nodiscard]] std::span<const std::uint32_t> triangles_around(std::uint32_t position) const {
    return std::span(triangle_of_corner)
        .subspan(first_corner[position], first_corner[position + 1] - first_corner[position]);
  }
};

}  // namespace meshlode::build
