// SPDX-License-Identifier: GPL-3.0-or-later
// Group: clusters that share borders are joined into groups that are simplified together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace meshlode::builder {

struct GroupOptions {
  std::uint32_t target_clusters = 20;  ///< what groups aim at; a retry takes another number to get other neighbours
  std::uint32_t max_clusters = 32;
  std::uint64_t max_weight = ~0ULL;  ///< largest sum of cluster_weight in a group (bytes: a group fits a page)
  std::uint32_t seed = 1;            ///< of the partitioner
};

/// The clusters of one level in compressed rows.
struct GroupInput {
  std::vector<std::uint32_t> first_position;  ///< cluster count + 1
  std::vector<std::uint32_t> positions;       ///< distinct position ids of each cluster, ascending
  std::vector<Vec3d> centers;                 ///< one point per cluster, for spatial nearness
  std::vector<std::uint64_t> weights;         ///< per cluster
  std::uint32_t position_count = 0;           ///< ids are below this

  [[nodiscard]] std::uint32_t cluster_count() const { return static_cast<std::uint32_t>(centers.size()); }
};

/// Groups as lists of ascending cluster ids, ordered by their first cluster. Every cluster is in exactly one.
[[nodiscard]] std::vector<std::vector<std::uint32_t>> group_clusters(const GroupInput& input,
                                                                     const GroupOptions& options);

}  // namespace meshlode::builder
