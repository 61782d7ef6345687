// SPDX-License-Identifier: GPL-3.0-or-later
#include "deviation/group_edges.h"

#include <algorithm>
#include <bit>

namespace meshlode {

GroupEdges::GroupEdges(const GroupSurface& group)
    : of_triangle(group.triangles.size()), is_border_position(group.positions.size(), 0) {
  constexpr std::uint32_t kEmpty = 0xFFFFFFFFU;
  // Open addressing; numbers are given in the order of the triangles.
  std::vector<std::uint32_t> slots(std::bit_ceil(6 * group.triangles.size() + 1), kEmpty);
  std::vector<std::uint64_t> keys;
  keys.reserve(2 * group.triangles.size());
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = group.triangles[t][k], b = group.triangles[t][(k + 1) % 3];
      const std::uint64_t key = static_cast<std::uint64_t>(std::min(a, b)) << 32U | std::max(a, b);
      std::uint64_t h = key * 0x9E3779B97F4A7C15ULL;
      h ^= h >> 32U;
      std::size_t at = h & (slots.size() - 1);
      while (slots[at] != kEmpty && keys[slots[at]] != key) at = (at + 1) & (slots.size() - 1);
      if (slots[at] == kEmpty) {
        slots[at] = static_cast<std::uint32_t>(keys.size());
        keys.push_back(key);
        use_count.push_back(0);
      }
      of_triangle[t][k] = slots[at];
      ++use_count[slots[at]];
    }
  }
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_border(static_cast<std::uint32_t>(t), k)) continue;
      is_border_position[group.triangles[t][k]] = 1;
      is_border_position[group.triangles[t][(k + 1) % 3]] = 1;
    }
  }
}

}  // namespace meshlode
