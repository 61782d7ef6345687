// SPDX-License-Identifier: GPL-3.0-or-later
// What of a group must stay as it is: because another group has it too, or because a border is locked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace meshlode::builder {

struct GroupLocks {
  std::vector<std::uint8_t> is_vertex_shared;  ///< with another group
  std::vector<std::uint8_t> is_vertex_locked;  ///< shared, or on a locked border
  std::vector<std::uint8_t> is_wedge_locked;   ///< on a locked vertex of the group as it came
  std::vector<std::uint8_t> is_wedge_shared;   ///< another group has it too, so that shading is smooth across

  /// `wedge_position` and `locked_border` as in SimplifyInput.
  GroupLocks(std::vector<std::uint8_t> shared_vertices, std::vector<std::uint8_t> shared_wedges,
             const std::vector<std::uint32_t>& wedge_position, const std::vector<std::uint8_t>& locked_border = {})
      : is_vertex_shared(std::move(shared_vertices)),
        is_vertex_locked(is_vertex_shared),
        is_wedge_locked(wedge_position.size(), 0),
        is_wedge_shared(std::move(shared_wedges)) {
    for (std::size_t v = 0; v < locked_border.size(); ++v) is_vertex_locked[v] |= locked_border[v];
    for (std::size_t w = 0; w < wedge_position.size(); ++w) is_wedge_locked[w] = is_vertex_locked[wedge_position[w]];
  }
};

}  // namespace meshlode::builder
