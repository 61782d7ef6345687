// SPDX-License-Identifier: GPL-3.0-or-later
// What thinned-out groups become: on a coarse grid cards meet each other and what is beside them by chance.
#include "builder/dag/aggregate_dag.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

using Place = std::tuple<int, int, int>;
using Edge = std::pair<Place, Place>;

/// A field of blades that are some steps of the grid wide.
LodDag thinned_grass(std::uint32_t blades, double step) {
  scene::Primitive grass = lab::make_grass(blades);
  grass.normals.clear();
  grass.uvs[0].clear();
  PrepareOptions coarse;
  coarse.grid_step = step;
  Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(std::move(grass)), {}, coarse);
  EXPECT_TRUE(mesh.ok()) << mesh.error().message();
  const std::vector<SourceMaterial> materials(1);
  Result<LodDag> dag = build_aggregate_dag_and_free(*mesh, materials, {});
  EXPECT_TRUE(dag.ok()) << dag.error().message();
  return std::move(*dag);
}

/// Calls visit(cluster, edge) for all.
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

TEST(AggregateDag, GroupsShareNoEdgeButWithWhatTheyReplace) {
  const LodDag dag = thinned_grass(20000, 0.01);
  std::vector<std::uint32_t> next(dag.groups.size(), kNoId);  // the group that what a group made is a member of
  for (const DagCluster& cluster : dag.clusters) {
    if (cluster.own_group.is_valid()) next[cluster.own_group.value] = cluster.coarser_group.value;
  }
  const auto replaces = [&](const DagCluster& coarse, const DagCluster& fine) {
    std::uint32_t g = fine.coarser_group.value;
    while (g != kNoId && GroupId(g) != coarse.own_group) g = next[g];
    return g != kNoId;
  };
  std::map<Edge, std::vector<const DagCluster*>> owners;
  for_each_edge(dag, [&](const DagCluster& cluster, const Edge& edge) {
    std::vector<const DagCluster*>& all = owners[edge];
    if (all.empty() || all.back() != &cluster) all.push_back(&cluster);
  });
  std::size_t shared = 0, made = 0;
  for (const auto& [edge, clusters] : owners) {
    for (const DagCluster* a : clusters) {
      made += a->level > 0 ? 1 : 0;
      for (const DagCluster* b : clusters) {
        if (a->own_group == b->own_group) continue;  // of a group, or the source's own
        ++shared;
        EXPECT_TRUE(replaces(*a, *b) || replaces(*b, *a)) << a->own_group.value << ' ' << b->own_group.value;
      }
    }
  }
  EXPECT_GT(made, 20000U);
  EXPECT_GT(std::count_if(dag.groups.begin(), dag.groups.end(), [](const DagGroup& g) { return g.level == 0; }), 8);
  EXPECT_GT(shared, 1000U) << "a blade stays where it was, in another level";
}

TEST(AggregateDag, NoGroupTakesMoreThanAPageThoughAPieceDoes) {
  scene::Primitive grass = lab::make_grass(1000);
  grass.normals.clear();
  grass.uvs[0].clear();
  constexpr std::uint32_t kSide = 100;
  const auto first = static_cast<std::uint32_t>(grass.positions.size());
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x)
      grass.positions.emplace_back(0.01F * static_cast<float>(x), 0.5F, 0.01F * static_cast<float>(y));
  }
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t v = first + kSide * y + x;
      for (const std::uint32_t corner : {v, v + 1, v + kSide, v + kSide, v + 1, v + kSide + 1})
        grass.indices.push_back(corner);
    }
  }
  Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(std::move(grass)), {}, {});
  ASSERT_TRUE(mesh.ok()) << mesh.error().message();
  const std::size_t triangles = mesh->triangles.size();
  DagOptions options;
  options.max_group_bytes = 65536;
  const auto bytes_of = [](std::uint32_t vertices, std::uint32_t count, std::uint32_t materials) {
    return 64 * materials + 12 * vertices + 3 * count;
  };
  options.cluster_bytes = bytes_of;
  const std::vector<SourceMaterial> materials(1);
  Result<LodDag> dag = build_aggregate_dag_and_free(*mesh, materials, options);
  ASSERT_TRUE(dag.ok()) << dag.error().message();
  std::vector<std::uint32_t> bytes(dag->groups.size(), 0);
  std::size_t at_level_0 = 0;
  for (const DagCluster& cluster : dag->clusters) {
    bytes[cluster.coarser_group.value] += bytes_of(cluster.vertex_count, cluster.triangle_count, 1);
    at_level_0 += cluster.level == 0 ? cluster.triangle_count : 0;
  }
  EXPECT_EQ(at_level_0, triangles);
  EXPECT_LE(*std::max_element(bytes.begin(), bytes.end()), options.max_group_bytes);
  EXPECT_GT(dag->level_count, 1U) << "what fits is replaced";
}

}  // namespace
}  // namespace meshlode::builder
