// SPDX-License-Identifier: GPL-3.0-or-later
// Which triangle of level 0 is which of the source: told by where the grid has its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "builder/promise/painted_source.h"
#include "builder/promise/product_tree.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Of triangles that are the same one on both sides, but for what quantization moves: of each the other's, or kNoId.
struct Partners {
  std::vector<std::uint32_t> of_finer, of_coarser;
};

/// A triangle by where the grid has its corners, whichever is called its first.
using GridCorners = std::array<std::array<double, 3>, 3>;
inline GridCorners least_turn(const GridCorners& corners) {
  const auto& [a, b, c] = corners;
  return std::min({corners, GridCorners{b, c, a}, GridCorners{c, a, b}});
}

/// Of triangles of the source, by their numbers in `painted`, and of the clusters of level 0, as they will be decoded.
/// Of triangles in the same place, which differ in what is painted on them, each has one of its own, whichever.
template <std::size_t D>
Partners find_partners(const PaintedSource& painted, std::span<const std::uint32_t> numbers,
                       const ProductSurface<D>& level0, const format::PositionGrid& grid) {
  std::vector<std::pair<GridCorners, std::uint32_t>> known(level0.triangles.size());
  parallel_for_each_index(known.size(), kLoopGrain, [&](std::size_t t) {
    GridCorners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const ProductPoint<D>& p = level0.points[level0.triangles[t][k]];
      corners[k] = {p[0], p[1], p[2]};
    }
    known[t] = {least_turn(corners), static_cast<std::uint32_t>(t)};
  });
  std::sort(known.begin(), known.end());
  Partners partners{std::vector<std::uint32_t>(numbers.size(), kNoId), std::vector<std::uint32_t>(known.size(), kNoId)};
  std::vector<std::uint32_t> taken(known.size(), 0);  // of those from here on that are in the same place
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    GridCorners corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d p = grid.decode(painted.on_grid[painted.wedges[numbers[i]][k]]);
      corners[k] = {p.x, p.y, p.z};
    }
    const std::pair<GridCorners, std::uint32_t> wanted{least_turn(corners), 0};
    const auto first = static_cast<std::size_t>(std::lower_bound(known.begin(), known.end(), wanted) - known.begin());
    if (first == known.size()) continue;
    const std::size_t next = first + taken[first];
    if (next >= known.size() || known[next].first != wanted.first) continue;
    ++taken[first];
    partners.of_finer[i] = known[next].second;
    partners.of_coarser[known[next].second] = static_cast<std::uint32_t>(i);
  }
  return partners;
}

}  // namespace meshlode::builder
