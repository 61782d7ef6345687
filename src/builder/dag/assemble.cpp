// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "base/unset_vector.h"
#include "builder/dag/level_pool.h"
#include "builder/gap_label.h"

namespace meshlode::builder {

namespace {

/// Writes a cluster's triangles to the places that it was given, by material, stable, and of its vertices the wedges:
/// by first use again where the triangles come in another order.
void write_cluster(const BuildPool& pool, const BuildCluster& source, const DagCluster& cluster, LodDag& dag,
                   std::span<std::uint32_t> wedge_of_vertex) {
  std::vector<std::uint32_t> triangles(source.triangle_count);
  std::iota(triangles.begin(), triangles.end(), source.first_triangle);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return material_of(pool.triangle_material[a]) < material_of(pool.triangle_material[b]);
  };
  if (!std::is_sorted(triangles.begin(), triangles.end(), before)) {
    std::stable_sort(triangles.begin(), triangles.end(), before);
  }
  std::array<std::uint32_t, 256> number;  // by vertex as it was, a byte; kNoId: not met yet
  number.fill(kNoId);
  const std::span<const std::uint32_t> vertices = pool.vertices_of(source);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t t = triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint8_t vertex = pool.triangles[t][k];
      if (number[vertex] == kNoId) {
        wedge_of_vertex[cluster.first_vertex + count] = vertices[vertex];
        number[vertex] = count++;
      }
      dag.triangles[cluster.first_triangle + i][k] = static_cast<std::uint8_t>(number[vertex]);
    }
    dag.triangle_material[cluster.first_triangle + i] = material_of(pool.triangle_material[t]);
  }
}

/// Gives every cluster its place and writes them all. `sources`: of the pool, in order.
/// What has been written is freed in the pool, so that little of it is there twice: vertices alone, while they are
/// copied.
void write_clusters(BuildPool& pool, const std::vector<ClusterId>& sources, std::size_t stride, LodDag& dag) {
  constexpr std::size_t kGrain = 16;
  std::uint32_t vertices = 0, triangles = 0;
  for (DagCluster& cluster : dag.clusters) {
    cluster.first_vertex = vertices;
    cluster.first_triangle = triangles;
    vertices += cluster.vertex_count;
    triangles += cluster.triangle_count;
  }
  UnsetVector<std::uint32_t> wedge_of_vertex(vertices);
  resize_all(triangles, dag.triangles, dag.triangle_material);
  parallel_for_each_index(sources.size(), kGrain, [&](std::size_t i) {
    write_cluster(pool, pool.cluster(sources[i]), dag.clusters[i], dag, wedge_of_vertex);
  });
  release(pool.triangles, pool.vertices, pool.clusters, pool.groups);
  pool.triangle_material = {};
  const auto write_positions = [&] {
    dag.vertex_position.resize(vertices);
    parallel_for_each_index(vertices, kLoopGrain, [&](std::size_t v) {
      dag.vertex_position[v] = pool.positions[pool.wedge_position[wedge_of_vertex[v]]];
    });
    release(pool.positions, pool.wedge_position);
  };
  const auto write_attributes = [&] {
    dag.vertex_attributes.resize(std::size_t{vertices} * stride);
    parallel_for_each_index(vertices, kLoopGrain, [&](std::size_t v) {
      std::copy_n(pool.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(wedge_of_vertex[v] * stride), stride,
                  dag.vertex_attributes.begin() + static_cast<std::ptrdiff_t>(v * stride));
    });
    release(pool.wedge_attributes);
  };
  parallel_all(write_positions, write_attributes);
}

}  // namespace

LodDag assemble_dag(BuildPool&& pool, const PreparedMesh& mesh) {
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
  dag.groups.reserve(pool.groups.size());
  dag.clusters.reserve(pool.clusters.size());
  std::vector<ClusterId> sources;
  sources.reserve(pool.clusters.size());
  for (const std::uint32_t g : order) {
    const BuildGroup& source = pool.groups[g];
    DagGroup group;
    group.level = source.level;
    group.first_cluster = static_cast<std::uint32_t>(dag.clusters.size());
    group.cluster_count = static_cast<std::uint32_t>(source.clusters.size());
    group.is_terminal = source.is_terminal;
    group.is_aggregate = source.is_aggregate;
    group.stuck_reason = source.stuck_reason;
    const double infinity = std::numeric_limits<double>::infinity();
    group.error = group.quadric_error = source.is_terminal ? infinity : source.quadric_error;
    for (const ClusterId c : source.clusters) {
      const BuildCluster& made = pool.cluster(c);
      DagCluster cluster;
      cluster.level = made.level;
      cluster.coarser_group = GroupId(new_group[g]);
      if (made.own_group.is_valid()) cluster.own_group = GroupId(new_group[made.own_group.value]);
      cluster.triangle_count = made.triangle_count;
      cluster.vertex_count = made.vertex_count;
      dag.level_count = std::max(dag.level_count, cluster.level + 1);
      dag.clusters.push_back(cluster);
      sources.push_back(c);
    }
    dag.groups.push_back(group);
  }
  write_clusters(pool, sources, mesh.layout.stride(), dag);
  return dag;
}

}  // namespace meshlode::builder
