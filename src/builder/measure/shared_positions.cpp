// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/shared_positions.h"

#include <algorithm>

namespace meshlode::builder {

void LevelUse::begin(std::uint32_t level) {
  std::fill(owner_.begin(), owner_.end(), kNobody);
  std::uint32_t first_owner = kNobody;
  is_one_group_ = true;
  for (const DagCluster& cluster : dag_.clusters) {
    const DagGroup& coarser = dag_.groups[cluster.coarser_group.value];
    const bool is_made = cluster.level <= level;
    const bool is_gone = !coarser.is_terminal && coarser.level < level;
    if (!is_made || is_gone) continue;
    const bool is_replaced = !coarser.is_terminal && coarser.level == level;
    const std::uint32_t owner = is_replaced ? cluster.coarser_group.value : kNotReplaced;
    if (first_owner == kNobody) first_owner = owner;
    is_one_group_ = is_one_group_ && owner == first_owner;
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      std::uint32_t& known = owner_[position_of_vertex_[v]];
      if (known == kNobody) {
        known = owner;
      } else if (known != owner) {
        known = kShared;
      }
    }
  }
}

}  // namespace meshlode::builder
