// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/level_use.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

/// The lists one after the other, under dense ids; `first` says where each begins, and the last ends.
void join_lists(const std::vector<BuildPool::ClusterUse>& uses, std::vector<std::uint32_t> BuildPool::ClusterUse::*list,
                std::size_t limit, DenseIds& dense, std::vector<std::uint32_t>& first,
                std::vector<std::uint32_t>& joined) {
  dense = DenseIds(limit);
  first.assign(uses.size() + 1, 0);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    for (const std::uint32_t id : uses[i].*list) dense.add(id);
    first[i + 1] = first[i] + static_cast<std::uint32_t>((uses[i].*list).size());
  }
  dense.finish();
  joined.resize(first.back());
  parallel_for_each_index(uses.size(), 64, [&](std::size_t i) {
    std::transform((uses[i].*list).begin(), (uses[i].*list).end(), joined.begin() + first[i],
                   [&](std::uint32_t id) { return dense[id]; });
  });
}

/// By dense id, whether clusters of more than one group have it.
std::vector<std::uint8_t> find_shared(const std::vector<std::uint32_t>& first, const std::vector<std::uint32_t>& ids,
                                      std::uint32_t count, const std::vector<std::vector<std::uint32_t>>& groups) {
  std::vector<std::uint8_t> is_shared(count, 0);
  std::vector<std::uint32_t> owner(count, kNoId);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    for (const std::uint32_t i : groups[g]) {
      for (const std::uint32_t id : std::span(ids).subspan(first[i], first[i + 1] - first[i])) {
        if (owner[id] == kNoId) owner[id] = g;
        if (owner[id] != g) is_shared[id] = 1;
      }
    }
  }
  return is_shared;
}

}  // namespace

LevelUse use_of_level(const BuildPool& pool, const std::vector<ClusterId>& live, const DagOptions& options) {
  LevelUse use;
  std::vector<BuildPool::ClusterUse> uses(live.size());
  use.grouping.weights.assign(live.size(), 0);
  use.grouping.centers.resize(live.size());
  parallel_for_each_index(live.size(), 16, [&](std::size_t i) {
    uses[i] = pool.use_of(live[i]);
    Vec3d sum(0.0);
    for (const std::uint32_t p : uses[i].positions) sum += Vec3d(pool.positions[p]);
    use.grouping.centers[i] = sum / static_cast<double>(std::max<std::size_t>(1, uses[i].positions.size()));
    if (options.max_group_bytes == 0) return;
    const auto wedges = static_cast<std::uint32_t>(uses[i].wedges.size());
    use.grouping.weights[i] = options.cluster_bytes(wedges, pool.cluster(live[i]).triangle_count, uses[i].materials);
  });
  parallel_all(
      [&] {
        join_lists(uses, &BuildPool::ClusterUse::positions, pool.positions.size(), use.dense_positions,
                   use.grouping.first_position, use.grouping.positions);
      },
      [&] {
        join_lists(uses, &BuildPool::ClusterUse::wedges, pool.wedge_position.size(), use.dense_wedges, use.first_wedge,
                   use.wedges);
      });
  use.grouping.position_count = use.dense_positions.count();
  return use;
}

Shared::Shared(const LevelUse& use, const std::vector<std::vector<std::uint32_t>>& groups) : use_(use) {
  parallel_all(
      [&] {
        is_position_shared_ =
            find_shared(use.grouping.first_position, use.grouping.positions, use.dense_positions.count(), groups);
      },
      [&] { is_wedge_shared_ = find_shared(use.first_wedge, use.wedges, use.dense_wedges.count(), groups); });
}

}  // namespace meshlode::builder
