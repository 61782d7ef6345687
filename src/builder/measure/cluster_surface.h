// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters of a DAG as a surface of positions and triangles.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "builder/lod_dag.h"
#include "format/grid.h"

namespace meshlode::builder {

struct ClusterSurface {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add(const LodDag& dag, const format::PositionGrid& grid, const DagCluster& cluster) {
    const auto base = static_cast<std::uint32_t>(positions.size());
    for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
      positions.push_back(grid.decode(dag.vertex_position[v]));
    }
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const auto& local = dag.triangles[t];
      triangles.push_back({base + local[0], base + local[1], base + local[2]});
    }
  }
};

}  // namespace meshlode::builder
