// SPDX-License-Identifier: GPL-3.0-or-later
// What of a group must stay as it is, because another group has it too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace meshlode::build {

struct GroupLocks {
  std::vector<std::uint8_t> is_vertex_locked;  ///< shared with another group
  std::vector<std::uint8_t> is_wedge_locked;   ///< on a locked vertex of the group as it came
  std::vector<std::uint8_t> is_wedge_shared;   ///< another group has it too, so that shading is smooth across

  /// `wedge_position` as in SimplifyInput.
  GroupLocks(std::vector<std::uint8_t> vertex_locks, std::vector<std::uint8_t> shared_wedges,
             const std::vector<std::uint32_t>& wedge_position)
      : is_vertex_locked(std::move(vertex_locks)),
        is_wedge_locked(wedge_position.size(), 0),
        is_wedge_shared(std::move(shared_wedges)) {
    for (std::size_t w = 0; w < wedge_position.size(); ++w) is_wedge_locked[w] = is_vertex_locked[wedge_position[w]];
  }
};

}  // namespace meshlode::build
