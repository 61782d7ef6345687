// SPDX-License-Identifier: GPL-3.0-or-later
// Which positions two groups of one round had in common: they were locked there, and stay where they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/lod_dag.h"

namespace meshlode::builder {

/// What is live in a round of the build, one round after the other. Asked by LodDag::vertex_position_id.
class RoundUse {
 public:
  explicit RoundUse(const LodDag& dag);

  /// Rounds are to be begun in ascending order.
  void begin(std::uint32_t round);
  /// Whether a cluster beside the position's own group, which the round replaces, has it too.
  [[nodiscard]] bool is_shared(std::uint32_t position) const { return owner_[position] == kShared; }
  /// Whether the round replaced all that was left of the mesh as one group.
  [[nodiscard]] bool is_one_group() const { return is_one_group_; }

 private:
  static constexpr std::uint32_t kNobody = 0xFFFFFFFFU, kShared = 0xFFFFFFFEU, kNotReplaced = 0xFFFFFFFDU;

  const LodDag& dag_;
  std::vector<std::uint32_t> owner_;  ///< per position: the group that has it in this round, or one of the above
  bool is_one_group_ = false;
};

}  // namespace meshlode::builder
