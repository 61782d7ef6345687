// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/build_dag.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"
#include "support/border_chain.h"

namespace meshlode::builder {
namespace {

using testing_support::Chain;

struct Built {
  PreparedMesh mesh;
  LodDag dag;
};

Built build(const scene::Primitive& shape, const DagOptions& options = {}) {
  const scene::SourceMesh source = lab::as_mesh(shape);
  const MeshPlan plan = plan_mesh(source, {}, {AttributeChoice::kAll}, "m");
  Built built{*prepare_mesh(source, plan.layout, {}), {}};
  Result<LodDag> dag = build_dag(built.mesh, options);
  EXPECT_TRUE(dag.ok());
  if (dag.ok()) built.dag = std::move(*dag);
  return built;
}

std::array<testing_support::Point, 3> corners(const LodDag& dag, const DagCluster& cluster, std::uint32_t triangle) {
  std::array<testing_support::Point, 3> out;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = testing_support::point(dag.vertex_position[cluster.first_vertex + dag.triangles[triangle][k]]);
  }
  return out;
}

void add_cluster(Chain& chain, const LodDag& dag, std::size_t c) {
  const DagCluster& cluster = dag.clusters[c];
  for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
    testing_support::add_triangle(chain, corners(dag, cluster, t));
  }
}

/// I1, I2, I5's structure and I6 of one DAG.
void expect_sound(const Built& built) {
  const LodDag& dag = built.dag;
  // I1: level 0 is the prepared mesh, triangle by triangle.
  using Key = std::tuple<std::array<testing_support::Point, 3>, std::uint32_t>;
  const auto rotated = [](std::array<testing_support::Point, 3> c) {
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    return c;
  };
  std::multiset<Key> expected;
  for (std::size_t t = 0; t < built.mesh.triangles.size(); ++t) {
    std::array<testing_support::Point, 3> c;
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] = testing_support::point(built.mesh.positions[built.mesh.wedge_position[built.mesh.triangles[t][k]]]);
    }
    expected.insert({rotated(c), built.mesh.triangle_material[t]});
  }
  std::multiset<Key> found;
  std::set<std::uint32_t> source_borders;
  for (const DagCluster& cluster : dag.clusters) {
    EXPECT_GE(cluster.triangle_count, 1U);
    EXPECT_LE(cluster.triangle_count, 128U);
    EXPECT_LE(cluster.vertex_count, 256U);
    EXPECT_EQ(cluster.level == 0, !cluster.own_group.is_valid());
    if (cluster.level != 0) continue;
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      found.insert({rotated(corners(dag, cluster, t)), dag.triangle_material[t]});
    }
  }
  EXPECT_TRUE(found == expected);

  // Groups partition the clusters; whatever a group makes is one level above it and has at least its error.
  std::uint32_t next = 0;
  std::vector<std::vector<std::size_t>> made(dag.groups.size());
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    const DagGroup& group = dag.groups[g];
    EXPECT_EQ(group.first_cluster, next);
    next += group.cluster_count;
    EXPECT_GE(group.cluster_count, 1U);
    std::uint32_t level = 0;
    for (std::uint32_t c = group.first_cluster; c < next; ++c) {
      EXPECT_EQ(dag.clusters[c].coarser_group.value, g);
      level = std::max(level, dag.clusters[c].level);
      if (dag.clusters[c].own_group.is_valid()) {
        EXPECT_LE(dag.groups[dag.clusters[c].own_group.value].error, group.error);
        made[dag.clusters[c].own_group.value].push_back(c);
      }
    }
    EXPECT_EQ(group.level, level);
    EXPECT_EQ(group.is_terminal, std::isinf(group.error));
  }
  EXPECT_EQ(next, dag.clusters.size());
  for (std::size_t g = 0; g < dag.groups.size(); ++g) {
    if (dag.groups[g].is_terminal) {
      EXPECT_TRUE(made[g].empty());
      continue;
    }
    ASSERT_FALSE(made[g].empty());
    for (const std::size_t c : made[g]) EXPECT_EQ(dag.clusters[c].level, dag.groups[g].level + 1);
  }

  // I6, group by group from fine to coarse. Only edges of the source's border may be replaced.
  Chain border;
  for (std::size_t c = 0; c < dag.clusters.size(); ++c) {
    if (dag.clusters[c].level == 0) add_cluster(border, dag, c);
  }
  std::set<std::pair<testing_support::Point, testing_support::Point>> free_edges;
  for (const auto& [edge, count] : border) free_edges.insert(edge);
  for (std::size_t g = dag.groups.size(); g-- > 0;) {
    const DagGroup& group = dag.groups[g];
    if (group.is_terminal) continue;
    Chain fine;
    Chain coarse;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c)
      add_cluster(fine, dag, c);
    for (const std::size_t c : made[g]) add_cluster(coarse, dag, c);
    for (const auto& [edge, count] : fine) {
      const auto other = coarse.find(edge);
      const bool is_kept = other != coarse.end() && other->second == count;
      EXPECT_TRUE(is_kept || free_edges.count(edge) == 1) << "group " << g;
    }
    for (const auto& [edge, count] : coarse) {
      if (fine.count(edge) == 0) free_edges.insert(edge);
    }
    EXPECT_TRUE(!border.empty() || fine == coarse) << "group " << g;
  }
}

std::size_t count_roots(const LodDag& dag) {
  std::size_t roots = 0;
  for (const DagGroup& group : dag.groups) roots += group.is_terminal ? group.cluster_count : 0;
  return roots;
}

TEST(Dag, SmoothShapesEndInOneRoot) {
  const scene::Primitive shapes[] = {lab::make_sphere(24), lab::make_torus(60, 30),
                                     lab::make_plane(40),  lab::with_smooth_normals(lab::make_sphere(20)),
                                     lab::make_rock(16),   lab::make_terrain(48, 48)};
  for (const scene::Primitive& shape : shapes) {
    const Built built = build(shape);
    expect_sound(built);
    EXPECT_EQ(count_roots(built.dag), 1U);
    // Halving gives twice the source; the last dozen clusters go by thirds, which costs so many clusters more.
    EXPECT_LE(built.dag.triangles.size(), built.mesh.triangles.size() * 202 / 100 + 8 * std::size_t{126});
  }
}

TEST(Dag, HardShapesAreSound) {
  const scene::Primitive shapes[] = {lab::make_box_soup(60),
                                     lab::make_loose_pieces(400),
                                     lab::make_blade(40),
                                     lab::make_three_sheets(24),
                                     lab::make_double_cone(300),
                                     lab::make_slivers(600),
                                     lab::make_duplicates(12),
                                     lab::make_zero_areas(12),
                                     lab::make_moebius(90, 8),
                                     lab::make_far_plane(24),
                                     lab::scaled(lab::make_torus(30, 20), 1e-6),
                                     lab::scaled(lab::make_torus(30, 20), 1e9)};
  for (const scene::Primitive& shape : shapes) expect_sound(build(shape));
}

TEST(Dag, FacetedShapesEndInOneRoot) {
  scene::Primitive shape = lab::with_split_normals(lab::make_sphere(20));
  for (const bool keep : {false, true}) {
    if (keep) shape.normals[0] = glm::normalize(shape.normals[0] + Vec3f(0.4F, 0.2F, 0.1F));  // now they must be stored
    const Built built = build(shape);
    EXPECT_EQ(built.mesh.layout.has_normal, keep);
    expect_sound(built);
    EXPECT_EQ(count_roots(built.dag), 1U);
  }
}

TEST(Dag, OneTriangleIsItsOwnRoot) {
  scene::Primitive shape;
  shape.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  shape.indices = {0, 1, 2};
  const Built built = build(shape);
  expect_sound(built);
  ASSERT_EQ(built.dag.groups.size(), 1U);
  EXPECT_TRUE(built.dag.groups[0].is_terminal);
  EXPECT_EQ(built.dag.groups[0].stuck_reason, StuckReason::kNotStuck);
}

TEST(Dag, AnEmptyMeshHasNoGroups) {
  const Built built = build(scene::Primitive{});
  EXPECT_TRUE(built.dag.groups.empty());
  EXPECT_EQ(built.dag.level_count, 0U);
}

TEST(Dag, MaterialsOfOneMeshShareOneDagWithoutCracks) {
  scene::SourceMesh source = lab::as_mesh(lab::make_sphere(20));
  scene::Primitive upper = source.primitives[0];
  scene::Primitive lower = upper;
  upper.indices.clear();
  lower.indices.clear();
  const scene::Primitive& whole = source.primitives[0];
  for (std::size_t i = 0; i < whole.indices.size(); i += 3) {
    auto& side = whole.positions[whole.indices[i]].y > 0.1 ? upper : lower;
    side.indices.insert(side.indices.end(), whole.indices.begin() + static_cast<std::ptrdiff_t>(i),
                        whole.indices.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  upper.material = MaterialId(0U);
  lower.material = MaterialId(1U);
  source.primitives = {upper, lower};
  Built built{*prepare_mesh(source, {}, {}), {}};
  built.dag = *build_dag(built.mesh, {});
  expect_sound(built);
  EXPECT_EQ(count_roots(built.dag), 1U);
  const DagCluster& root = built.dag.clusters[0];
  std::set<std::uint32_t> materials;
  for (std::uint32_t t = 0; t < root.triangle_count; ++t)
    materials.insert(built.dag.triangle_material[root.first_triangle + t]);
  EXPECT_EQ(materials.size(), 2U) << "the root still has both materials";
}

TEST(Dag, ThreadsChangeNothing) {
  const scene::Primitive shape = lab::make_rock(24);
  std::vector<LodDag> dags;
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    dags.push_back(build(shape).dag);
  }
  for (const LodDag& dag : dags) {
    EXPECT_EQ(dag.vertex_position, dags[0].vertex_position);
    EXPECT_EQ(dag.vertex_attributes, dags[0].vertex_attributes);
    EXPECT_EQ(dag.triangles, dags[0].triangles);
  }
}

TEST(Dag, ItCanBeCancelled) {
  DagOptions options;
  int calls = 0;
  options.on_level = [&](std::uint32_t, std::uint64_t) { return ++calls < 3; };
  const PreparedMesh mesh = *prepare_mesh(lab::as_mesh(lab::make_sphere(20)), {}, {});
  const Result<LodDag> dag = build_dag(mesh, options);
  ASSERT_FALSE(dag.ok());
  EXPECT_EQ(dag.error().code, ErrorCode::kBuildFailed);
  EXPECT_EQ(calls, 3);
}

TEST(Dag, FoliageAndSoupsKeepTheirAreaAtEveryLevel) {
  DagOptions options;
  options.simplify.keep_area = true;
  for (const scene::Primitive& shape : {lab::make_box_soup(1500), lab::make_foliage(1200)}) {
    const Built built = build(shape, options);
    expect_sound(built);
    EXPECT_LE(count_roots(built.dag), 4U);
    std::map<std::uint32_t, double> area;
    for (const DagCluster& cluster : built.dag.clusters) {
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        const auto p = [&](std::size_t k) {
          return Vec3d(built.dag.vertex_position[cluster.first_vertex + built.dag.triangles[t][k]]);
        };
        area[cluster.level] += 0.5 * glm::length(glm::cross(p(1) - p(0), p(2) - p(0)));
      }
    }
    EXPECT_GE(area.size(), 4U);
    for (const auto& [level, covered] : area) EXPECT_NEAR(covered / area[0], 1.0, 0.1) << "level " << level;
  }
}

TEST(Dag, GroupsStayWithinTheirBytes) {
  DagOptions options;
  options.max_group_bytes = 128 * 6;
  options.cluster_bytes = [](std::uint32_t, std::uint32_t triangles, std::uint32_t) { return triangles; };
  const Built built = build(lab::make_sphere(24), options);
  expect_sound(built);
  for (const DagGroup& group : built.dag.groups) {
    std::uint32_t bytes = 0;
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      bytes += built.dag.clusters[c].triangle_count;
    }
    EXPECT_TRUE(bytes <= options.max_group_bytes || group.cluster_count == 1);
  }
}

}  // namespace
}  // namespace meshlode::builder
