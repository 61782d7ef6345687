// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/join_dags.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace meshlode::builder {

namespace {

/// A group of one of the two.
struct From {
  std::uint32_t part = 0, group = 0;
};

}  // namespace

LodDag join_dags(const LodDag& first, const LodDag& second, const AttributeLayout& layout) {
  const std::array<const LodDag*, 2> parts{&first, &second};
  std::vector<From> order;
  for (std::uint32_t part = 0; part < 2; ++part) {
    for (std::uint32_t g = 0; g < parts[part]->groups.size(); ++g) order.push_back({part, g});
  }
  // As assemble_dag() has it; within a part groups are in that order already.
  std::stable_sort(order.begin(), order.end(), [&](const From& a, const From& b) {
    const DagGroup &x = parts[a.part]->groups[a.group], &y = parts[b.part]->groups[b.group];
    if (x.level != y.level) return x.level > y.level;
    return x.is_terminal && !y.is_terminal;
  });
  std::array<std::vector<std::uint32_t>, 2> new_group;
  for (std::size_t part = 0; part < 2; ++part) new_group[part].resize(parts[part]->groups.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) new_group[order[i].part][order[i].group] = i;

  LodDag dag;
  dag.level_count = std::max(first.level_count, second.level_count);
  const auto stride = static_cast<std::ptrdiff_t>(layout.stride());
  const auto append = [](auto& to, const auto& from, std::ptrdiff_t begin, std::ptrdiff_t count) {
    to.insert(to.end(), from.begin() + begin, from.begin() + begin + count);
  };
  for (const From& from : order) {
    const LodDag& part = *parts[from.part];
    DagGroup group = part.groups[from.group];
    const std::uint32_t first_cluster = group.first_cluster;
    group.first_cluster = static_cast<std::uint32_t>(dag.clusters.size());
    group.normal_deviation = group.uv_deviation = std::numeric_limits<double>::infinity();
    if (group.is_terminal && group.stuck_reason == StuckReason::kNotStuck)
      group.stuck_reason = StuckReason::kComponents;
    dag.groups.push_back(group);
    for (std::uint32_t c = first_cluster; c < first_cluster + group.cluster_count; ++c) {
      DagCluster cluster = part.clusters[c];
      const std::ptrdiff_t vertex = cluster.first_vertex, triangle = cluster.first_triangle;
      cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
      cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
      cluster.coarser_group = GroupId(new_group[from.part][cluster.coarser_group.value]);
      if (cluster.own_group.is_valid()) cluster.own_group = GroupId(new_group[from.part][cluster.own_group.value]);
      append(dag.vertex_position, part.vertex_position, vertex, cluster.vertex_count);
      append(dag.vertex_attributes, part.vertex_attributes, vertex * stride, cluster.vertex_count * stride);
      append(dag.triangles, part.triangles, triangle, cluster.triangle_count);
      append(dag.triangle_material, part.triangle_material, triangle, cluster.triangle_count);
      dag.clusters.push_back(cluster);
    }
  }
  return dag;
}

}  // namespace meshlode::builder
