// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/shared_positions.h"

#include <algorithm>

namespace meshlode::builder {

RoundUse::RoundUse(const LodDag& dag) : dag_(dag) {
  std::uint32_t positions = 0;
  for (const std::uint32_t id : dag.vertex_position_id) positions = std::max(positions, id + 1);
  owner_.resize(positions);
}

void RoundUse::begin(std::uint32_t round) {
  std::fill(owner_.begin(), owner_.end(), kNobody);
  std::uint32_t first_owner = kNobody;
  is_one_group_ = true;
  for (const DagCluster& cluster : dag_.clusters) {
    const DagGroup& coarser = dag_.groups[cluster.coarser_group.value];
    const bool is_made = !cluster.own_group.is_valid() || dag_.groups[cluster.own_group.value].round < round;
    const bool is_gone = !coarser.is_terminal && coarser.round < round;
    if (!is_made || is_gone) continue;
    const bool is_replaced = !coarser.is_terminal && coarser.round == round;
    const std::uint32_t owner = is_replaced ? cluster.coarser_group.value : kNotReplaced;
    if (first_owner == kNobody) first_owner = owner;
    is_one_group_ = is_one_group_ && owner == first_owner;
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      std::uint32_t& known = owner_[dag_.vertex_position_id[v]];
      if (known == kNobody) {
        known = owner;
      } else if (known != owner) {
        known = kShared;
      }
    }
  }
}

}  // namespace meshlode::builder
