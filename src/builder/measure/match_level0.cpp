// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/id_table.h"
#include "builder/measure/source_units.h"
#include "builder/prepared.h"

namespace meshlode::builder {

namespace {

using Corners = std::array<Vec3i, 3>;

Corners in_order(Corners corners) {
  std::sort(corners.begin(), corners.end(), [](const Vec3i& a, const Vec3i& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  return corners;
}

std::uint64_t hash_of(const Corners& corners) {
  std::uint64_t h = 0;
  for (const Vec3i& q : corners) {
    for (int k = 0; k < 3; ++k) h = hash_word(h, static_cast<std::uint32_t>(q[k]));
  }
  return h;
}

}  // namespace

std::vector<std::uint32_t> match_level0(const PreparedMesh& mesh, const LodDag& dag) {
  std::vector<std::uint32_t> cluster_of(dag.triangles.size(), kNoId);
  const auto dag_corners = [&](std::uint32_t t) {
    const std::uint32_t base = dag.clusters[cluster_of[t]].first_vertex;
    const auto& l = dag.triangles[t];
    return in_order(
        {dag.vertex_position[base + l[0]], dag.vertex_position[base + l[1]], dag.vertex_position[base + l[2]]});
  };
  IdTable table(mesh.triangles.size());
  const auto hash = [&](std::uint32_t t) { return hash_of(dag_corners(t)); };
  for (std::uint32_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].own_group.is_valid()) continue;
    const std::uint32_t first = dag.clusters[c].first_triangle;
    for (std::uint32_t t = first; t < first + dag.clusters[c].triangle_count; ++t) {
      cluster_of[t] = c;
      const Corners corners = dag_corners(t);
      (void)table.find_or_insert(
          hash_of(corners), t, [&](std::uint32_t other) { return dag_corners(other) == corners; }, hash);
    }
  }
  std::vector<std::uint32_t> result(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = [&](std::size_t k) { return mesh.positions[mesh.wedge_position[mesh.triangles[t][k]]]; };
    const Corners corners = in_order({at(0), at(1), at(2)});
    const std::uint32_t found =
        table.find(hash_of(corners), [&](std::uint32_t other) { return dag_corners(other) == corners; });
    result[t] = found == IdTable::kNone ? 0 : cluster_of[found];
  }
  return result;
}

}  // namespace meshlode::builder
