// SPDX-License-Identifier: GPL-3.0-or-later
// DAGs made by hand, and what samples say of any cut.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "builder/deviation/point_distance.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder::test {

using Soup = std::vector<TriangleCorners>;

/// A LodDag of triangles given one by one; the grid's step is 2^-10.
struct HandMade {
  PreparedMesh mesh;
  LodDag dag;

  HandMade() {
    mesh.grid.log2 = -10;
    mesh.diagonal = 4.0;
  }
  /// Groups from coarse to fine, then their members.
  void add_group(std::uint32_t level, bool is_terminal) {
    DagGroup group;
    group.level = level;
    group.is_terminal = is_terminal;
    if (is_terminal) group.error = std::numeric_limits<double>::infinity();
    group.first_cluster = static_cast<std::uint32_t>(dag.clusters.size());
    dag.groups.push_back(group);
  }
  void add_cluster(std::uint32_t level, GroupId own, const Soup& triangles) {
    DagCluster cluster;
    cluster.level = level;
    cluster.own_group = own;
    cluster.coarser_group = GroupId(dag.groups.size() - 1);
    cluster.first_vertex = static_cast<std::uint32_t>(dag.vertex_position.size());
    cluster.first_triangle = static_cast<std::uint32_t>(dag.triangles.size());
    for (const TriangleCorners& t : triangles) {
      const auto base = static_cast<std::uint8_t>(dag.vertex_position.size() - cluster.first_vertex);
      for (const Vec3d& p : t) dag.vertex_position.push_back(Vec3i(glm::round(p * 1024.0)));
      dag.triangles.push_back({base, static_cast<std::uint8_t>(base + 1), static_cast<std::uint8_t>(base + 2)});
      if (own.is_valid()) continue;
      const auto first = static_cast<std::uint32_t>(mesh.exact_positions.size());
      mesh.exact_positions.insert(mesh.exact_positions.end(), t.begin(), t.end());
      for (const Vec3d& p : t) mesh.exact_on_grid.push_back(Vec3i(glm::round(p * 1024.0)));
      mesh.exact_triangles.push_back({first, first + 1, first + 2});
    }
    cluster.vertex_count = static_cast<std::uint32_t>(dag.vertex_position.size()) - cluster.first_vertex;
    cluster.triangle_count = static_cast<std::uint32_t>(dag.triangles.size()) - cluster.first_triangle;
    dag.clusters.push_back(cluster);
    ++dag.groups.back().cluster_count;
  }
};

/// What is drawn where errors may be `threshold`.
inline Soup cut_of(const PreparedMesh& mesh, const LodDag& dag, double threshold) {
  Soup soup;
  for (const DagCluster& c : dag.clusters) {
    const bool is_made = !c.own_group.is_valid() || dag.groups[c.own_group.value].error <= threshold;
    if (!is_made || dag.groups[c.coarser_group.value].error <= threshold) continue;
    for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
      TriangleCorners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        corners[k] = mesh.grid.decode(dag.vertex_position[c.first_vertex + dag.triangles[t][k]]);
      }
      soup.push_back(corners);
    }
  }
  return soup;
}

inline Soup source_of(const PreparedMesh& mesh) {
  Soup soup;
  for (const auto& t : mesh.exact_triangles) {
    soup.push_back({mesh.exact_positions[t[0]], mesh.exact_positions[t[1]], mesh.exact_positions[t[2]]});
  }
  return soup;
}

/// The largest distance of points of `from` to `to`, a lower bound of the truth, or `known` where none is farther.
inline double sampled_distance(const Soup& from, const Soup& to, int parts, double known = 0.0) {
  std::vector<TriangleDistance> distances(to.begin(), to.end());
  double most2 = known * known;
  std::size_t last = 0;  // near to the point before
  for (const TriangleCorners& t : from) {
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        const Vec3d p = t[0] + (t[1] - t[0]) * (1.0 * i / parts) + (t[2] - t[0]) * (1.0 * j / parts);
        if (!distances.empty() && distances[last].squared_to(p) <= most2) continue;
        double least2 = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < distances.size() && least2 > most2; ++k) {
          const double one2 = distances[k].squared_to(p);
          if (one2 < least2) last = k;
          least2 = std::min(least2, one2);
        }
        most2 = std::max(most2, least2);
      }
    }
  }
  return std::sqrt(most2);
}

}  // namespace meshlode::builder::test
