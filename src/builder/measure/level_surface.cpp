// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/level_surface.h"

#include "base/parallel.h"

namespace meshlode::builder {

LevelSurface::LevelSurface(const LodDag& dag, const format::PositionGrid& grid,
                           std::span<const std::uint32_t> position_of_vertex, std::uint32_t first_group,
                           std::uint32_t end_group, std::span<const std::vector<std::uint32_t>> outputs) {
  const std::uint32_t level = dag.groups[first_group].level;
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const GroupId own = dag.clusters[c].own_group;
    const DagGroup& coarser = dag.groups[dag.clusters[c].coarser_group.value];
    const bool is_there = !own.is_valid() || dag.groups[own.value].level < level;
    if (is_there && (coarser.is_terminal || coarser.level > level)) add(dag, grid, c);
  }
  for (std::uint32_t g = first_group; g < end_group; ++g) {
    start.push_back(static_cast<std::uint32_t>(triangles.size()));
    for (const std::uint32_t c : outputs[g]) add(dag, grid, c);
  }
  start.push_back(static_cast<std::uint32_t>(triangles.size()));
  neighbor = link_edges(std::span<const Triangle>(triangles),
                        [&](std::uint32_t corner) { return position_of_vertex[dag_vertex_[corner]]; });
  normal.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain,
                          [&](std::size_t k) { normal[k] = unit_normal(corners(static_cast<std::uint32_t>(k))); });
  tree.build({positions, triangles});
  slot.resize(triangles.size());
  parallel_for_each_index(triangles.size(), kLoopGrain,
                          [&](std::size_t i) { slot[tree.triangle_at(TreeSlot(i))] = TreeSlot(i); });
}

void LevelSurface::add(const LodDag& dag, const format::PositionGrid& grid, std::uint32_t cluster_id) {
  const DagCluster& from = dag.clusters[cluster_id];
  const auto base = static_cast<std::uint32_t>(positions.size());
  for (std::uint32_t v = from.first_vertex; v < from.first_vertex + from.vertex_count; ++v) {
    dag_vertex_.push_back(v);
    positions.push_back(grid.decode(dag.vertex_position[v]));
  }
  for (std::uint32_t t = from.first_triangle; t < from.first_triangle + from.triangle_count; ++t) {
    const auto& local = dag.triangles[t];
    triangles.push_back({base + local[0], base + local[1], base + local[2]});
    cluster.push_back(cluster_id);
  }
}

}  // namespace meshlode::builder
