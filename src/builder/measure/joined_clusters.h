// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters of a DAG as one surface: corners in one place on the grid are one position.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/local_ids.h"
#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Positions are in the order of their ids.
struct JoinedClusters {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< cluster by cluster

  JoinedClusters(const LodDag& dag, const format::PositionGrid& grid, std::span<const std::uint32_t> position_of_vertex,
                 std::span<const std::uint32_t> clusters) {
    std::size_t count = 0;
    for (const std::uint32_t c : clusters) count += dag.clusters[c].triangle_count;
    triangles.reserve(count);
    LocalIds ids(count);
    std::vector<Vec3i> on_grid;
    for (const std::uint32_t c : clusters) {
      const DagCluster& cluster = dag.clusters[c];
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        std::array<std::uint32_t, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t vertex = cluster.first_vertex + dag.triangles[t][k];
          corners[k] = ids.add(position_of_vertex[vertex]);
          if (corners[k] == on_grid.size()) on_grid.push_back(dag.vertex_position[vertex]);
        }
        triangles.push_back(corners);
      }
    }
    const std::vector<std::uint32_t> place = ids.sort();
    positions.resize(on_grid.size());
    for (std::size_t p = 0; p < on_grid.size(); ++p) positions[place[p]] = grid.decode(on_grid[p]);
    for (auto& corners : triangles) {
      for (std::uint32_t& corner : corners) corner = place[corner];
    }
  }
  [[nodiscard]] GroupSurface surface() const { return {positions, triangles}; }
};

}  // namespace meshlode::builder
