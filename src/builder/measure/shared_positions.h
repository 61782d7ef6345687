// SPDX-License-Identifier: GPL-3.0-or-later
// Which positions a group has in common with what is left of its mesh: they were locked, and stay where they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/lod_dag.h"

namespace meshlode::builder {

/// What is live when the groups of a level are replaced, one level after the other. A group that got stuck was replaced
/// later than its level: its neighbours may have been others then.
class LevelUse {
 public:
  /// `position_of_vertex`: CanonicalForm's; both outlive this.
  LevelUse(const LodDag& dag, std::span<const std::uint32_t> position_of_vertex, std::size_t position_count)
      : dag_(dag), position_of_vertex_(position_of_vertex), owner_(position_count) {}

  void begin(std::uint32_t level);
  /// Whether a cluster beside the position's own group, which is of the level, has it too.
  [[nodiscard]] bool is_shared(std::uint32_t position) const { return owner_[position] == kShared; }
  /// Whether the level is all that is left of the mesh, and one group.
  [[nodiscard]] bool is_one_group() const { return is_one_group_; }

 private:
  static constexpr std::uint32_t kNobody = 0xFFFFFFFFU, kShared = 0xFFFFFFFEU, kNotReplaced = 0xFFFFFFFDU;

  const LodDag& dag_;
  std::span<const std::uint32_t> position_of_vertex_;
  std::vector<std::uint32_t> owner_;  ///< per position: the group of the level that has it, or one of the above
  bool is_one_group_ = false;
};

}  // namespace meshlode::builder
