// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <numeric>

#include "build/dag/level_pool.h"

namespace meshlode::build {

namespace {

/// Appends one cluster: triangles sorted by material (stable), vertices numbered by first use.
void append_cluster(const BuildPool& pool, const BuildCluster& source, std::size_t stride, GroupId group, LodDag& dag) {
  DagCluster cluster;
  cluster.level = source.level;
  cluster.own_group = source.own_group;  // renumbered by the caller
  cluster.coarser_group = group;
  cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
  cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
  cluster.triangle_count = source.triangle_count;

  std::vector<std::uint32_t> order(source.triangle_count);
  std::iota(order.begin(), order.end(), source.first_triangle);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return pool.triangle_material[a] < pool.triangle_material[b];
  });
  std::vector<std::uint32_t> vertices;  // wedge ids; at most a few hundred, so that linear search is quick enough
  const auto local_vertex = [&](std::uint32_t wedge) {
    const auto found = std::find(vertices.begin(), vertices.end(), wedge);
    if (found != vertices.end()) return static_cast<std::size_t>(found - vertices.begin());
    vertices.push_back(wedge);
    return vertices.size() - 1;
  };
  for (const std::uint32_t t : order) {
    std::array<std::uint8_t, 3> local{};
    for (std::size_t k = 0; k < 3; ++k) local[k] = static_cast<std::uint8_t>(local_vertex(pool.triangles[t][k]));
    dag.triangles.push_back(local);
    dag.triangle_material.push_back(pool.triangle_material[t]);
  }
  for (const std::uint32_t wedge : vertices) {
    dag.vertex_position.push_back(pool.positions[pool.wedge_position[wedge]]);
    const auto first = pool.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(wedge * stride);
    dag.vertex_attributes.insert(dag.vertex_attributes.end(), first, first + static_cast<std::ptrdiff_t>(stride));
  }
  cluster.vertex_count = static_cast<std::uint32_t>(vertices.size());
  dag.clusters.push_back(cluster);
}

}  // namespace

LodDag assemble_dag(const BuildPool& pool, const PreparedMesh& mesh) {
  const std::size_t stride = mesh.layout.stride();
  std::vector<std::uint32_t> order(pool.groups.size());
  std::iota(order.begin(), order.end(), 0U);
  // A group comes after everything made from it. Its level is below theirs, so that sorting by level does it; terminal
  // groups come first within their level.
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const BuildGroup& x = pool.groups[a];
    const BuildGroup& y = pool.groups[b];
    if (x.level != y.level) return x.level > y.level;
    if (x.is_terminal != y.is_terminal) return x.is_terminal;
    return a < b;
  });
  std::vector<std::uint32_t> new_group(pool.groups.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) new_group[order[i]] = i;

  LodDag dag;
  for (const std::uint32_t g : order) {
    const BuildGroup& source = pool.groups[g];
    DagGroup group;
    group.level = source.level;
    group.first_cluster = static_cast<std::uint32_t>(dag.clusters.size());
    group.cluster_count = static_cast<std::uint32_t>(source.clusters.size());
    group.is_terminal = source.is_terminal;
    group.stuck_reason = source.stuck_reason;
    const double infinity = std::numeric_limits<double>::infinity();
    group.error = source.is_terminal ? infinity : source.error;
    group.quadric_error = source.is_terminal ? infinity : source.quadric_error;
    group.deviation = source.deviation;
    group.normal_deviation = source.normal_deviation;
    group.uv_deviation = source.uv_deviation;
    for (const ClusterId c : source.clusters) {
      append_cluster(pool, pool.cluster(c), stride, GroupId(new_group[g]), dag);
      DagCluster& cluster = dag.clusters.back();
      if (cluster.own_group.is_valid()) cluster.own_group = GroupId(new_group[cluster.own_group.value]);
      dag.level_count = std::max(dag.level_count, cluster.level + 1);
    }
    dag.groups.push_back(group);
  }
  return dag;
}

}  // namespace meshlode::build
