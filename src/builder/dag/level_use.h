// SPDX-License-Identifier: GPL-3.0-or-later
// What the clusters of a level use of the pool, under dense ids: the pool has all levels, and tables as long as it is
// would be made and cleared again for each.
#pragma once

#include <cstdint>
#include <vector>

#include "base/dense_ids.h"
#include "base/ids.h"
#include "builder/cluster/group.h"
#include "builder/dag/build_dag.h"
#include "builder/dag/level_pool.h"

namespace meshlode::builder {

struct LevelUse {
  GroupInput grouping;                     ///< of the level's clusters, in their order; positions are dense
  std::vector<std::uint32_t> first_wedge;  ///< cluster count + 1
  std::vector<std::uint32_t> wedges;       ///< distinct dense ids of each cluster
  DenseIds dense_positions, dense_wedges;  ///< by id in the pool
};

[[nodiscard]] LevelUse use_of_level(const BuildPool& pool, const std::vector<ClusterId>& live,
                                    const DagOptions& options);

/// What more than one group uses. Asked by ids in the pool, of what the level uses.
class Shared {
 public:
  /// `groups` are lists of the level's clusters. `use` must outlive this.
  Shared(const LevelUse& use, const std::vector<std::vector<std::uint32_t>>& groups);

  [[nodiscard]] std::uint8_t position(std::uint32_t id) const { return is_position_shared_[use_.dense_positions[id]]; }
  [[nodiscard]] std::uint8_t wedge(std::uint32_t id) const { return is_wedge_shared_[use_.dense_wedges[id]]; }

 private:
  const LevelUse& use_;
  std::vector<std::uint8_t> is_position_shared_, is_wedge_shared_;  ///< by dense id
};

}  // namespace meshlode::builder
