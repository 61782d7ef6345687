// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/measure/level_surface.h"

#include "base/parallel.h"

namespace meshlode::builder {

LevelSurface::LevelSurface(const LodDag& dag, const format::PositionGrid& grid, const CanonicalForm& form,
                           std::uint32_t first_group, std::uint32_t end_group,
                           std::span<const std::vector<std::uint32_t>> outputs) {
  const std::uint32_t level = dag.groups[first_group].level;
  std::vector<std::uint32_t> clusters;
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    const GroupId own = dag.clusters[c].own_group;
    const DagGroup& coarser = dag.groups[dag.clusters[c].coarser_group.value];
    const bool is_there = !own.is_valid() || dag.groups[own.value].level < level;
    if (is_there && (coarser.is_terminal || coarser.level > level)) clusters.push_back(c);
  }
  std::size_t count = 0;
  for (const std::uint32_t c : clusters) count += dag.clusters[c].triangle_count;
  for (std::uint32_t g = first_group; g < end_group; ++g) {
    start.push_back(static_cast<std::uint32_t>(count));
    for (const std::uint32_t c : outputs[g]) count += dag.clusters[c].triangle_count;
    clusters.insert(clusters.end(), outputs[g].begin(), outputs[g].end());
  }
  start.push_back(static_cast<std::uint32_t>(count));
  add(dag, grid, form, clusters, count);
  const auto link = [&] {
    neighbor = link_edges(triangles, positions.size(), [](std::uint32_t corner) { return corner; });
  };
  const auto find_normals = [&] {
    normal.resize(triangles.size());
    parallel_for_each_index(triangles.size(), kLoopGrain,
                            [&](std::size_t k) { normal[k] = unit_normal(corners(static_cast<std::uint32_t>(k))); });
  };
  const auto build_tree = [&] {
    tree.build({positions, triangles});
    slot.resize(triangles.size());
    parallel_for_each_index(triangles.size(), kLoopGrain,
                            [&](std::size_t i) { slot[tree.triangle_at(TreeSlot(i))] = TreeSlot(i); });
  };
  parallel_all(link, find_normals, build_tree);
}

void LevelSurface::add(const LodDag& dag, const format::PositionGrid& grid, const CanonicalForm& form,
                       std::span<const std::uint32_t> clusters, std::size_t triangle_count) {
  triangles.reserve(triangle_count);
  std::vector<std::uint32_t> first_use;                        // per position, a vertex of the DAG
  first_use.reserve(triangle_count * 5 / 8);                   // a closed surface has half as many
  std::vector<std::uint32_t> own(form.position_count, kNoId);  // of the DAG's positions
  for (const std::uint32_t c : clusters) {
    const DagCluster& from = dag.clusters[c];
    for (std::uint32_t t = from.first_triangle; t < from.first_triangle + from.triangle_count; ++t) {
      Triangle& corners = triangles.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = from.first_vertex + dag.triangles[t][k];
        std::uint32_t& id = own[form.position_of_vertex[vertex]];
        if (id == kNoId) {
          id = static_cast<std::uint32_t>(first_use.size());
          first_use.push_back(vertex);
        }
        corners[k] = id;
      }
    }
  }
  const auto decode = [&] {
    positions.resize(first_use.size());
    parallel_for_each_index(first_use.size(), kLoopGrain,
                            [&](std::size_t p) { positions[p] = grid.decode(dag.vertex_position[first_use[p]]); });
  };
  const auto name_clusters = [&] {
    cluster.reserve(triangle_count);
    for (const std::uint32_t c : clusters) cluster.insert(cluster.end(), dag.clusters[c].triangle_count, c);
  };
  parallel_all(decode, name_clusters);
}

}  // namespace meshlode::builder
