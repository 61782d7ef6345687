// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a group's surface: numbered, and which of them are its border.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "builder/deviation/deviation.h"

namespace meshlode::builder {

struct GroupEdges {
  explicit GroupEdges(const GroupSurface& group);

  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< edge k of a triangle: from its corner k to the next
  std::vector<std::uint32_t> use_count;                   ///< per edge: triangles that have it
  std::vector<std::uint8_t> is_border_position;           ///< per position: an edge with one triangle ends there

  [[nodiscard]] bool is_border(std::uint32_t triangle, std::size_t k) const {
    return use_count[of_triangle[triangle][k]] == 1;
  }
};

/// Per triangle: whether it has an edge that is folded by more than 60 degrees, or that has not two triangles.
[[nodiscard]] std::vector<std::uint8_t> find_folded(const GroupSurface& surface, const GroupEdges& edges);

}  // namespace meshlode::builder
