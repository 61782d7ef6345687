// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle by its material and its corners on the mesh's grid: what level 0 and the source are compared by.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>

namespace meshlode::judge {

using GridPoint = std::array<std::int32_t, 3>;
using GridCorners = std::array<GridPoint, 3>;

struct TriangleKey {
  std::uint32_t material = 0;
  GridCorners corners{};  ///< rotated so that the smallest rotation comes first: orientation is kept
  auto operator<=>(const TriangleKey&) const = default;
};

[[nodiscard]] inline GridCorners rotate_to_smallest(const GridCorners& c) {
  const GridCorners b{c[1], c[2], c[0]};
  const GridCorners a{c[2], c[0], c[1]};
  return std::min({c, b, a});
}

}  // namespace meshlode::judge
