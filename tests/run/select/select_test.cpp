// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts of whole DAGs: each piece of surface exactly once (I5), and the BVH agrees with the flat rule (I8).
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "run/read/nesting.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TestTables;
using test::TransformKind;

constexpr TransformKind kKinds[] = {TransformKind::kIdentity, TransformKind::kRigid, TransformKind::kMirrored,
                                    TransformKind::kNonUniform, TransformKind::kSheared};

// Meshes of about 1e-6, 1 and 1e9 units, one far from its own origin, each with an instance of every kind.
TestTables make_tables(RandomSource& random, std::uint32_t leaf_clusters) {
  TestTables tables;
  for (const int log2 : {-40, -20, 10}) {
    test::RandomDagOptions options;
    options.leaf_clusters = leaf_clusters;
    options.grid_log2 = log2;
    const test::RandomDag made = test::make_random_dag(random, options);
    const double size = std::ldexp(1.0, log2 + 20);
    const std::uint32_t mesh = static_cast<std::uint32_t>(tables.meshes.size());
    tables.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), random.in_cube(size * 1e6));
    for (const TransformKind kind : kKinds) {
      tables.instances.push_back(test::make_random_instance(random, kind, random.chance(0.5) ? 0.0 : size * 100.0));
      tables.instances.back().mesh = mesh;
    }
  }
  return tables;
}

double random_pixel_error(RandomSource& random) {
  return random.chance(0.05) ? 0.0 : random.log_between(1e-4, 1e5);
}

// Walks from each level-0 cluster to a root, at random among the clusters made from each group.
void expect_each_path_has_one_drawn_cluster(RandomSource& random, const SelectTables& tables, std::uint32_t mesh_id,
                                            const std::set<std::uint32_t>& drawn) {
  const format::MeshRecord& mesh = tables.meshes[mesh_id];
  std::vector<std::vector<std::uint32_t>> made(mesh.group_count);
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const std::uint32_t own = tables.clusters[c].own_group;
    if (own != format::kNone) made[own - mesh.first_group].push_back(c);
  }
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    if (tables.clusters[c].own_group != format::kNone) continue;
    int count = 0;
    for (std::uint32_t at = c;;) {
      count += drawn.count(at) != 0 ? 1 : 0;
      const auto& coarser = made[tables.clusters[at].coarser_group - mesh.first_group];
      if (coarser.empty()) break;
      at = coarser[random.below(static_cast<std::uint32_t>(coarser.size()))];
    }
    ASSERT_EQ(count, 1) << "from cluster " << c;
  }
}

TEST(Select, DrawsEachPieceOfSurfaceExactlyOnceForRandomCameras) {
  RandomSource random(21);
  const TestTables owned = make_tables(random, 150);
  const SelectTables tables = owned.view();
  std::set<std::size_t> cut_sizes;
  for (std::size_t i = 0; i < tables.instances.size(); ++i) {
    for (int n = 0; n < 40; ++n) {
      const Camera camera = test::make_random_camera(random, tables, tables.instances[i]);
      std::set<std::uint32_t> drawn;
      for (const ClusterInstance& d : select_flat(tables, camera, random_pixel_error(random))) {
        if (d.instance.value == i) drawn.insert(d.cluster.value);
      }
      ASSERT_FALSE(drawn.empty());
      expect_each_path_has_one_drawn_cluster(random, tables, tables.instances[i].mesh, drawn);
      if (HasFatalFailure()) FAIL() << "instance " << i << ", camera " << n << ", seed 21";
      cut_sizes.insert(drawn.size());
    }
  }
  EXPECT_GT(cut_sizes.size(), 100U);  // the cameras do ask for different cuts
}

TEST(Select, BvhSelectsExactlyWhatTheFlatRuleSelects) {
  RandomSource random(22);
  for (const std::uint32_t leaf_clusters : {1U, 2U, 7U, 40U, 300U}) {
    const TestTables owned = make_tables(random, leaf_clusters);
    const SelectTables tables = owned.view();
    for (int n = 0; n < 800; ++n) {
      const format::InstanceRecord& near_one =
          tables.instances[random.below(static_cast<std::uint32_t>(tables.instances.size()))];
      const Camera camera = test::make_random_camera(random, tables, near_one);
      const double t = random_pixel_error(random);
      ASSERT_EQ(select_flat(tables, camera, t), select_bvh(tables, camera, t))
          << leaf_clusters << " clusters, camera " << n << ", seed 22";
    }
  }
}

TEST(Select, ACutOfMoreClustersThanAllowedIsNone) {
  RandomSource random(29);
  const TestTables owned = make_tables(random, 40U);
  const SelectTables tables = owned.view();
  for (int n = 0; n < 200; ++n) {
    const Camera camera = test::make_random_camera(random, tables, tables.instances[0]);
    const double t = random_pixel_error(random);
    const auto cut = select_bvh(tables, camera, t);
    EXPECT_EQ(select_bvh_within(tables, camera, t, cut.size()), cut);
    if (!cut.empty()) {
      EXPECT_FALSE(select_bvh_within(tables, camera, t, cut.size() - 1));
    }
  }
}

TEST(Select, BvhLooksAtLittleWhenTheCameraIsFar) {
  RandomSource random(23);
  TestTables owned;
  test::RandomDagOptions options;
  options.leaf_clusters = 4000;
  options.stuck_chance = 0.0;
  const test::RandomDag made = test::make_random_dag(random, options);
  owned.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), Vec3d(0.0));
  owned.instances.push_back(test::make_random_instance(random, TransformKind::kIdentity, 0.0));
  Camera camera;
  camera.eye = {0.0, 0.0, 1e4};
  TraversalCount count;
  EXPECT_EQ(select_bvh(owned.view(), camera, 1.0, &count).size(), select_flat(owned.view(), camera, 1.0).size());
  EXPECT_LT(count.nodes, 100U) << owned.groups.size() << " groups";
  // Everything is drawn at level 0: no node may be closed, and each is tested once.
  EXPECT_EQ(select_bvh(owned.view(), camera, 0.0, &count), select_flat(owned.view(), camera, 0.0));
  EXPECT_LE(count.nodes, owned.nodes.size());
}

TEST(Select, ANodeThatClaimsTooLittleIsNoticedAgainstTheFlatRule) {
  RandomSource random(24);
  TestTables owned = make_tables(random, 100);
  for (format::NodeRecord& node : owned.nodes) node.error *= node.error < format::kInfiniteError ? 0.01F : 1.0F;
  int different = 0;
  for (int n = 0; n < 200; ++n) {
    const Camera camera = test::make_random_camera(random, owned.view(), owned.instances[n % owned.instances.size()]);
    const double t = random_pixel_error(random);
    different += select_flat(owned.view(), camera, t) != select_bvh(owned.view(), camera, t) ? 1 : 0;
  }
  EXPECT_GT(different, 0);
}

TEST(Select, DrawsNothingOfASingularInstance) {
  RandomSource random(25);
  TestTables owned = make_tables(random, 20);
  owned.instances[1].flags |= format::kInstanceSingular;
  owned.instances[1].scale = std::nan("");
  for (const ClusterInstance& d : select_bvh(owned.view(), Camera{}, 1.0)) EXPECT_NE(d.instance.value, 1U);
  EXPECT_EQ(select_flat(owned.view(), Camera{}, 1.0), select_bvh(owned.view(), Camera{}, 1.0));
}

TEST(Select, SurvivesCamerasThatMakeNoSense) {
  RandomSource random(26);
  const TestTables owned = make_tables(random, 60);
  const double bad[] = {0.0, -1.0, HUGE_VAL, -HUGE_VAL, std::nan(""), 1e300, 1e-300};
  for (int n = 0; n < 3000; ++n) {
    Camera camera = test::make_random_camera(random, owned.view(), owned.instances[n % owned.instances.size()]);
    double t = 1.0;
    for (double* field : {&camera.eye.x, &camera.fovy, &camera.near_distance, &camera.ortho_height, &t}) {
      if (random.chance(0.4)) *field = bad[random.below(7)];
    }
    ASSERT_EQ(select_flat(owned.view(), camera, t), select_bvh(owned.view(), camera, t)) << n;
  }
}

/// Measured attribute deviations for every group: random, running maxima along the DAG, infinite at the roots.
void add_attribute_deviations(RandomSource& random, TestTables& tables) {
  for (format::MeshRecord& mesh : tables.meshes) {
    mesh.normal_mode = format::NormalMode::kStored;
    mesh.uv_set_count = 1;
  }
  for (format::GroupRecord& group : tables.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    group.normal_deviation = static_cast<float>(random.log_between(1e-2, 10.0));
    group.uv_deviation = static_cast<float>(random.log_between(1e-6, 1e-2));
  }
  for (std::size_t g = tables.groups.size(); g-- > 0;) {  // finer groups lie behind coarser ones
    format::GroupRecord& group = tables.groups[g];
    for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
      const std::uint32_t own = tables.clusters[c].own_group;
      if (own == format::kNone) continue;
      group.normal_deviation = std::max(group.normal_deviation, tables.groups[own].normal_deviation);
      group.uv_deviation = std::max(group.uv_deviation, tables.groups[own].uv_deviation);
    }
  }
}

AttributeBounds random_bounds(RandomSource& random) {
  AttributeBounds bounds;
  if (random.chance(0.7)) bounds.normal_degrees = random.chance(0.1) ? 0.0 : random.log_between(1e-2, 20.0);
  if (random.chance(0.7)) bounds.uv = random.chance(0.1) ? 0.0 : random.log_between(1e-6, 2e-2);
  return bounds;
}

TEST(Select, WithAttributeBoundsEachPieceIsDrawnOnceAndTheBvhAgrees) {
  RandomSource random(29);
  TestTables owned = make_tables(random, 150);
  add_attribute_deviations(random, owned);
  const SelectTables tables = owned.view();
  int changed = 0;
  for (int n = 0; n < 600; ++n) {
    const std::size_t i = random.below(static_cast<std::uint32_t>(tables.instances.size()));
    const Camera camera = test::make_random_camera(random, tables, tables.instances[i]);
    const double t = random_pixel_error(random);
    const AttributeBounds bounds = random_bounds(random);
    const auto cut = select_flat(tables, camera, t, bounds);
    ASSERT_EQ(cut, select_bvh(tables, camera, t, nullptr, bounds)) << "camera " << n << ", seed 29";
    changed += cut != select_flat(tables, camera, t) ? 1 : 0;
    std::set<std::uint32_t> drawn;
    for (const ClusterInstance& d : cut) {
      if (d.instance.value == i) drawn.insert(d.cluster.value);
    }
    std::vector<ClusterId> ids;
    for (const std::uint32_t id : drawn) ids.emplace_back(id);
    const CutAttributeDeviation deviation = attribute_deviation_of(tables, ids);
    ASSERT_LE(deviation.normal_degrees, bounds.normal_degrees) << "camera " << n << ", seed 29";
    ASSERT_LE(deviation.uv, bounds.uv) << "camera " << n << ", seed 29";
    CutAttributeDeviation worst;
    for (const std::uint32_t id : drawn) {
      if (tables.clusters[id].own_group == format::kNone) continue;
      const format::GroupRecord& own = tables.groups[tables.clusters[id].own_group];
      if (own.normal_deviation > worst.normal_degrees) worst.normal_degrees = own.normal_deviation;
      if (own.uv_deviation > worst.uv) worst.uv = own.uv_deviation;
    }
    ASSERT_EQ(deviation.normal_degrees, worst.normal_degrees) << "camera " << n << ", seed 29";
    ASSERT_EQ(deviation.uv, worst.uv) << "camera " << n << ", seed 29";
    expect_each_path_has_one_drawn_cluster(random, tables, tables.instances[i].mesh, drawn);
    if (HasFatalFailure()) FAIL() << "instance " << i << ", camera " << n << ", seed 29";
  }
  EXPECT_GT(changed, 100) << "the bounds do ask for finer cuts";
}

TEST(Select, UniformCutsKeepAttributeBoundsAndAreTheCoarsestThatDo) {
  RandomSource random(30);
  TestTables owned = make_tables(random, 100);
  add_attribute_deviations(random, owned);
  const SelectTables tables = owned.view();
  for (std::uint32_t m = 0; m < tables.meshes.size(); ++m) {
    for (int n = 0; n < 100; ++n) {
      const AttributeBounds bounds = random_bounds(random);
      const double error = random.chance(0.5) ? 1e30 : random.log_between(1e-9, 1e6);
      const UniformCut cut = select_uniform(tables, MeshId(m), error, CutError::kSelection, bounds);
      std::set<std::uint32_t> drawn;
      for (const ClusterId id : cut.clusters) {
        drawn.insert(id.value);
        const format::ClusterRecord& c = tables.clusters[id.value];
        const format::GroupRecord& coarser = tables.groups[c.coarser_group];
        EXPECT_FALSE(coarser.error <= error && is_within(bounds, coarser)) << "a coarser cluster would have done";
      }
      const CutAttributeDeviation deviation = attribute_deviation_of(tables, cut.clusters);
      EXPECT_LE(deviation.normal_degrees, bounds.normal_degrees);
      EXPECT_LE(deviation.uv, bounds.uv);
      expect_each_path_has_one_drawn_cluster(random, tables, m, drawn);
      if (HasFatalFailure()) FAIL() << "seed 30";
    }
  }
}

TEST(Select, BoundsOnWhatAMeshDoesNotStoreAreNone) {
  RandomSource random(31);
  TestTables owned = make_tables(random, 60);  // no normals, no UVs, nothing measured
  const AttributeBounds bounds{.normal_degrees = 1.0, .uv = 1e-3};
  for (std::uint32_t m = 0; m < owned.meshes.size(); ++m) {
    const auto roots = select_uniform(owned.view(), MeshId(m), 1e30).clusters;
    EXPECT_EQ(select_uniform(owned.view(), MeshId(m), 1e30, CutError::kSelection, bounds).clusters, roots);
    owned.meshes[m].normal_mode = format::NormalMode::kStored;
    const UniformCut cut = select_uniform(owned.view(), MeshId(m), 1e30, CutError::kSelection, bounds);
    for (const ClusterId id : cut.clusters) {
      EXPECT_EQ(owned.clusters[id.value].own_group, format::kNone) << "not measured: level 0 alone is sure";
    }
  }
}

TEST(Select, UniformCutFollowsItsDefinitionAndItsStoredErrorBoundsIt) {
  RandomSource random(27);
  TestTables owned = make_tables(random, 150);
  for (std::uint32_t m = 0; m < owned.meshes.size(); ++m) {
    owned.meshes[m].level0_deviation = static_cast<float>(std::ldexp(1.0, 10 * static_cast<int>(m)) * 1e-9);
    const SelectTables tables = owned.view();
    const format::MeshRecord& mesh = tables.meshes[m];
    float largest = 0.0F;
    for (const format::GroupRecord& g : tables.groups.subspan(mesh.first_group, mesh.group_count)) {
      if (g.error < format::kInfiniteError) largest = std::max(largest, g.error);
    }
    for (const CutError by : {CutError::kSelection, CutError::kQuadric}) {
      for (int n = 0; n < 60; ++n) {
        const double error = n == 0 ? 0.0 : n == 1 ? 2.0 * largest : largest * random.log_between(1e-6, 1.0);
        const auto value = [&](std::uint32_t g) {
          return by == CutError::kQuadric ? tables.groups[g].quadric_error : tables.groups[g].error;
        };
        const UniformCut cut = select_uniform(tables, MeshId(m), error, by);
        std::vector<ClusterId> expected;
        double stored = mesh.level0_deviation;
        for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
          const format::ClusterRecord& r = tables.clusters[c];
          const bool own_passes = r.own_group == format::kNone || value(r.own_group) <= error;
          if (!own_passes || value(r.coarser_group) <= error) continue;
          expected.push_back(ClusterId(c));
          if (r.own_group != format::kNone) stored = std::max(stored, double{tables.groups[r.own_group].error});
        }
        EXPECT_EQ(cut.clusters, expected);
        EXPECT_EQ(cut.stored_error, stored);
        std::set<std::uint32_t> drawn;
        for (const ClusterId id : cut.clusters) drawn.insert(id.value);
        expect_each_path_has_one_drawn_cluster(random, tables, m, drawn);
        if (HasFatalFailure()) FAIL() << "seed 27";
      }
    }
  }
}

TEST(Select, UniformCutsGrowNoFinerAsTheErrorGrows) {
  RandomSource random(28);
  const TestTables owned = make_tables(random, 150);
  for (std::uint32_t m = 0; m < owned.meshes.size(); ++m) {
    double stored = 0.0;
    std::size_t count = owned.clusters.size();
    const double size = std::ldexp(1.0, -20 + 30 * static_cast<int>(m == 2) - 20 * static_cast<int>(m == 0));
    for (int n = -10; n < 60; ++n) {
      const UniformCut cut = select_uniform(owned.view(), MeshId(m), std::ldexp(size, n));
      EXPECT_GE(cut.stored_error, stored);
      EXPECT_LE(cut.clusters.size(), count);
      stored = cut.stored_error;
      count = cut.clusters.size();
    }
  }
}

}  // namespace
}  // namespace meshlode::run
