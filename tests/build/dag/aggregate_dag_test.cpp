// SPDX-License-Identifier: GPL-3.0-or-later
// What thinned-out groups become: on a coarse grid cards meet each other and what is beside them by chance.
#include "build/dag/aggregate_dag.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "build/prepare/prepare.h"
#include "scene/samples/samples.h"

namespace meshlode::build {
namespace {

using Place = std::tuple<int, int, int>;
using Edge = std::pair<Place, Place>;

/// A field of blades that are some steps of the grid wide.
LodDag thinned_grass(const PlaceSet& others) {
  scene::Primitive grass = scene::make_grass(1000);
  grass.normals.clear();
  grass.uvs[0].clear();
  PrepareOptions coarse;
  coarse.grid_step = 0.004;
  Result<PreparedMesh> mesh = prepare_mesh(scene::as_mesh(std::move(grass)), {}, coarse);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message();
  const std::vector<SourceMaterial> materials(1);
  Result<LodDag> dag = build_aggregate_dag_and_free(*mesh, materials, {}, others);
  EXPECT_TRUE(dag.ok()) << dag.error().message();
  return std::move(*dag);
}

/// Calls visit(cluster, edge) for those above level 0.
template <class Visit>
void for_each_edge(const LodDag& dag, const Visit& visit) {
  for (const DagCluster& cluster : dag.clusters) {
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      std::array<Place, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3i& p = dag.vertex_position[cluster.first_vertex + dag.triangles[t][k]];
        corners[k] = {p.x, p.y, p.z};
      }
      for (std::size_t k = 0; k < 3; ++k) visit(cluster, Edge(std::minmax(corners[k], corners[(k + 1) % 3])));
    }
  }
}

TEST(AggregateDag, NoEdgeLiesBetweenPlacesOfOtherParts) {
  const LodDag alone = thinned_grass({});
  ASSERT_GE(alone.level_count, 3U);
  PlaceSet others;
  for (const DagCluster& cluster : alone.clusters) {
    for (std::uint32_t v = cluster.first_vertex; cluster.level > 0 && v < cluster.first_vertex + cluster.vertex_count; ++v)
      others.insert(alone.vertex_position[v]);
  }
  const LodDag beside = thinned_grass(others);
  EXPECT_EQ(beside.level_count, alone.level_count);
  EXPECT_EQ(beside.triangles.size(), alone.triangles.size());
  std::size_t count = 0;
  for_each_edge(beside, [&](const DagCluster& cluster, const Edge& edge) {
    if (cluster.level == 0) return;
    const auto is_other = [&](const Place& p) {
      return others.count(Vec3i(std::get<0>(p), std::get<1>(p), std::get<2>(p))) != 0;
    };
    ++count;
    EXPECT_FALSE(is_other(edge.first) && is_other(edge.second));
  });
  EXPECT_GT(count, 1000U);
}

TEST(AggregateDag, GroupsShareNoEdgeButWithWhatTheyReplace) {
  const LodDag dag = thinned_grass({});
  // Whether what a group made stands, in the end, for what another made.
  const auto replaces = [&](std::uint32_t coarse, std::uint32_t fine) {
    for (std::uint32_t g = fine; !dag.groups[g].is_terminal;) {
      const auto made = std::find_if(dag.clusters.begin(), dag.clusters.end(), [&](const DagCluster& cluster) {
        return cluster.own_group.is_valid() && cluster.own_group.value == g;
      });
      if (made == dag.clusters.end()) return false;
      g = made->coarser_group.value;
      if (g == coarse) return true;
    }
    return false;
  };
  std::map<Edge, std::set<std::uint32_t>> makers;
  for_each_edge(dag, [&](const DagCluster& cluster, const Edge& edge) {
    if (cluster.level > 0) makers[edge].insert(cluster.own_group.value);
  });
  for (const auto& [edge, groups] : makers) {
    for (const std::uint32_t a : groups) {
      for (const std::uint32_t b : groups) EXPECT_TRUE(a == b || replaces(a, b) || replaces(b, a)) << a << ' ' << b;
    }
  }
}

}  // namespace
}  // namespace meshlode::build
