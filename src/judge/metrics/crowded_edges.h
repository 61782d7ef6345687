// SPDX-License-Identifier: GPL-3.0-or-later
// How a set of triangles hangs together at its edges: which are open, and which have more triangles than a manifold's.
// A cut of a closed manifold is closed (I6), but where topology was broken on purpose it need not be a manifold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace meshlode::judge {

struct EdgeCounts {
  std::uint64_t edges = 0;  ///< distinct, between two positions
  std::uint64_t open =
      0;  ///< not used as often one way as the other: the chain is not 0 there (docs/reference/rules.md)
  std::uint64_t crowded = 0;  ///< of more than two triangles
};

/// Collects the edges of triangles, and counts them.
class EdgeCounter {
 public:
  /// Ids of positions, equal where positions are, below 2^31. Edges between equal positions are left out, as in the
  /// border proof; a triangle without area uses its others like any triangle.
  void add(const std::array<std::uint32_t, 3>& triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t from = triangle[k], to = triangle[(k + 1) % 3];
      if (from < to) uses_.push_back(from << 32U | to << 1U | 1U);
      if (from > to) uses_.push_back(to << 32U | from << 1U);
    }
  }
  /// Of what was added since the last count. O(n log n), 24 bytes a triangle.
  [[nodiscard]] EdgeCounts count();

 private:
  std::vector<std::uint64_t> uses_;  ///< lower id, higher id, whether it goes up
};

}  // namespace meshlode::judge
