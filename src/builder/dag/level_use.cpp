// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/level_use.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "base/parallel.h"

namespace meshlode::builder {

namespace {

/// The lists one after the other, under dense ids; `first` says where each begins, and the last ends.
template <class ListOf>
void join_lists(std::size_t count, const ListOf& list_of, std::size_t limit, DenseIds& dense,
                std::vector<std::uint32_t>& first, std::vector<std::uint32_t>& joined) {
  dense = DenseIds(limit);
  first.assign(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const std::uint32_t> list = list_of(i);
    for (const std::uint32_t id : list) dense.add(id);
    first[i + 1] = first[i] + static_cast<std::uint32_t>(list.size());
  }
  dense.finish();
  joined.resize(first.back());
  parallel_for_each_index(count, 64, [&](std::size_t i) {
    const std::span<const std::uint32_t> list = list_of(i);
    std::transform(list.begin(), list.end(), joined.begin() + first[i], [&](std::uint32_t id) { return dense[id]; });
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
  std::vector<std::vector<std::uint32_t>> positions(live.size());
  use.grouping.weights.assign(live.size(), 0);
  use.grouping.centers.resize(live.size());
  parallel_for_each_index(live.size(), 16, [&](std::size_t i) {
    const BuildCluster& cluster = pool.cluster(live[i]);
    positions[i] = pool.positions_of(cluster);
    Vec3d sum(0.0);
    for (const std::uint32_t p : positions[i]) sum += Vec3d(pool.positions[p]);
    use.grouping.centers[i] = sum / static_cast<double>(std::max<std::size_t>(1, positions[i].size()));
    if (options.max_group_bytes == 0) return;
    use.grouping.weights[i] =
        options.cluster_bytes(cluster.vertex_count, cluster.triangle_count, pool.count_materials(cluster));
  });
  parallel_all(
      [&] {
        join_lists(
            live.size(), [&](std::size_t i) { return std::span<const std::uint32_t>(positions[i]); },
            pool.positions.size(), use.dense_positions, use.grouping.first_position, use.grouping.positions);
      },
      [&] {
        join_lists(
            live.size(), [&](std::size_t i) { return pool.vertices_of(pool.cluster(live[i])); },
            pool.wedge_position.size(), use.dense_wedges, use.first_wedge, use.wedges);
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
