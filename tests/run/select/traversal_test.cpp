// SPDX-License-Identifier: GPL-3.0-or-later
// What the traversal looks at, node by node and member by member, and what it does with tables that are damaged or ask
// for nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "run/select/far_instance.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TestTables;
using test::TransformKind;

TestTables two_meshes(RandomSource& random, std::uint32_t leaf_clusters) {
  TestTables tables;
  for (std::uint32_t mesh = 0; mesh < 2; ++mesh) {
    test::RandomDagOptions options;
    options.leaf_clusters = leaf_clusters + mesh;
    const test::RandomDag made = test::make_random_dag(random, options);
    tables.add_mesh(made.dag, builder::build_hierarchy(made.dag, made.mesh), random.in_cube(10.0));
    for (const TransformKind kind : {TransformKind::kRigid, TransformKind::kSheared}) {
      tables.instances.push_back(test::make_random_instance(random, kind, 10.0));
      tables.instances.back().mesh = mesh;
    }
  }
  return tables;
}

void add_deviations(RandomSource& random, TestTables& tables) {
  for (format::MeshRecord& mesh : tables.meshes) {
    mesh.normal_mode = format::NormalMode::kStored;
    mesh.uv_set_count = 1;
  }
  for (format::GroupRecord& group : tables.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) continue;
    group.normal_deviation = static_cast<float>(random.log_between(0.1, 10.0));
    group.uv_deviation = static_cast<float>(random.log_between(1e-4, 1e-2));
  }
}

/// The rule on the nodes, from the root down: all nodes whose ancestors fail are looked at, and each member of a group
/// whose leaf fails.
TraversalCount looked_at(const SelectTables& tables, const Camera& camera, double pixel_error,
                         const AttributeBounds& bounds) {
  TraversalCount count;
  for (const format::InstanceRecord& instance : tables.instances) {
    const format::MeshRecord& mesh = tables.meshes[instance.mesh];
    const MetricView view = make_metric_view(camera, pixel_error, instance, mesh, mesh_reach(tables, mesh));
    const AttributeBounds own = bounds_for(bounds, mesh);
    const std::function<bool(std::uint32_t)> all_within = [&](std::uint32_t id) {
      const format::NodeRecord& node = tables.nodes[id];
      if (node.child_count == 0) return is_within(own, tables.groups[node.first]);
      bool all = true;
      for (std::uint32_t c = 0; c < node.child_count; ++c) all = all_within(node.first + c) && all;
      return all;
    };
    std::vector<std::uint32_t> open{mesh.first_node};
    while (!open.empty()) {
      const std::uint32_t id = open.back();
      const format::NodeRecord& node = tables.nodes[id];
      open.pop_back();
      ++count.nodes;
      if (metric_passes(view, node.center[0], node.center[1], node.center[2], node.radius, node.error) &&
          all_within(id))
        continue;
      if (node.child_count == 0) count.clusters += tables.groups[node.first].cluster_count;
      for (std::uint32_t c = 0; c < node.child_count; ++c) open.push_back(node.first + c);
    }
  }
  return count;
}

TEST(Traversal, LooksBelowWhatFailsAndNowhereElse) {
  RandomSource random(201);
  TestTables owned = two_meshes(random, 60);
  add_deviations(random, owned);
  const SelectTables tables = owned.view();
  for (int n = 0; n < 400; ++n) {
    const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(4)]);
    const double t = random.log_between(1e-3, 1e4);
    AttributeBounds bounds;
    if (n % 4 == 1 || n % 4 == 3) bounds.normal_degrees = random.log_between(0.1, 20.0);
    if (n % 4 >= 2) bounds.uv = random.log_between(1e-4, 2e-2);
    TraversalCount count;
    const auto cut = select_bvh(tables, camera, t, &count, bounds);
    const TraversalCount expected = looked_at(tables, camera, t, bounds);
    ASSERT_EQ(count.nodes, expected.nodes) << "seed 201, camera " << n;
    ASSERT_EQ(count.clusters, expected.clusters) << "seed 201, camera " << n;
    ASSERT_EQ(cut, select_flat(tables, camera, t, bounds)) << "seed 201, camera " << n;
  }
}

// Whatever instance the limit falls on, and between two as well.
TEST(Traversal, ACutIsWholeOrNone) {
  RandomSource random(202);
  const TestTables owned = two_meshes(random, 12);
  const SelectTables tables = owned.view();
  for (int n = 0; n < 40; ++n) {
    const Camera camera = test::make_random_camera(random, tables, tables.instances[random.below(4)]);
    const double t = random.log_between(1e-3, 1e4);
    const auto cut = select_bvh(tables, camera, t);
    for (std::size_t most = 0; most < cut.size(); ++most)
      ASSERT_FALSE(select_bvh_within(tables, camera, t, most)) << most << " of " << cut.size();
    for (const std::size_t more : {0U, 1U, 100U})
      ASSERT_EQ(select_bvh_within(tables, camera, t, cut.size() + more), cut);
  }
}

TEST(Traversal, DamagedTablesEndAndDrawNothingOfWhatIsNotThere) {
  RandomSource random(203);
  const TestTables whole = two_meshes(random, 30);
  const auto drawn_of = [&](const TestTables& tables, std::uint32_t instance) {
    std::size_t flat = 0, bvh = 0;
    for (const ClusterInstance& d : select_flat(tables.view(), Camera{}, 0.0)) flat += d.instance.value == instance;
    for (const ClusterInstance& d : select_bvh(tables.view(), Camera{}, 0.0)) bvh += d.instance.value == instance;
    EXPECT_EQ(flat, bvh);
    return flat;
  };
  EXPECT_GT(drawn_of(whole, 0), 0U);
  EXPECT_GT(drawn_of(whole, 3), 0U);
  TestTables none = whole;
  none.instances[3].mesh = 2;
  EXPECT_EQ(drawn_of(none, 3), 0U) << "there is no third mesh";
  none.instances[3].mesh = 0xFFFFFFFFU;
  EXPECT_EQ(drawn_of(none, 3), 0U);
  EXPECT_EQ(drawn_of(none, 0), drawn_of(whole, 0));
  TestTables singular = whole;
  singular.instances[0].flags |= format::kInstanceSingular;
  EXPECT_EQ(drawn_of(singular, 0), 0U);
  TestTables empty = whole;
  empty.meshes[0].group_count = empty.meshes[0].cluster_count = empty.meshes[0].node_count = 0;
  EXPECT_EQ(drawn_of(empty, 0), 0U);
  EXPECT_EQ(drawn_of(empty, 3), drawn_of(whole, 3));
  // A node whose children are itself, or before it.
  for (const std::uint32_t back : {0U, 1U}) {
    TestTables looping = whole;
    const std::uint32_t at = looping.meshes[1].first_node;
    ASSERT_GT(looping.nodes[at].child_count, 0U);
    looping.nodes[at].first = at - back;
    EXPECT_EQ(select_bvh(looping.view(), Camera{}, 0.0).size(), drawn_of(whole, 0) + drawn_of(whole, 1))
        << "of the other mesh alone";
    AttributeBounds bounds;
    bounds.uv = 1.0;
    EXPECT_EQ(find_nodes_within(looping.view(), looping.meshes[1], bounds).size(), looping.meshes[1].node_count);
  }
}

TEST(Traversal, NodesWithinBoundsAreThoseAboveNothingElse) {
  RandomSource random(204);
  TestTables owned = two_meshes(random, 80);
  add_deviations(random, owned);
  const SelectTables tables = owned.view();
  for (int n = 0; n < 60; ++n) {
    AttributeBounds bounds;
    if (n % 2 == 0) bounds.normal_degrees = random.log_between(1.0, 20.0);
    if (n % 3 != 0) bounds.uv = random.log_between(1e-3, 2e-2);
    for (const format::MeshRecord& mesh : tables.meshes) {
      const std::vector<std::uint8_t> within = find_nodes_within(tables, mesh, bounds);
      for (std::uint32_t i = mesh.node_count; i-- > 0;) {
        const format::NodeRecord& node = tables.nodes[mesh.first_node + i];
        bool expected = true;
        if (node.child_count == 0) expected = is_within(bounds, tables.groups[node.first]);
        for (std::uint32_t c = 0; c < node.child_count; ++c)
          expected = expected && within[node.first + c - mesh.first_node] != 0;
        ASSERT_EQ(within[i] != 0, expected) << "seed 204, node " << i;
      }
    }
  }
}

TEST(Traversal, BoundsCountWhereTheMeshHasWhatTheyBound) {
  AttributeBounds bounds;
  EXPECT_FALSE(bounds.has_any());
  bounds.normal_degrees = 3.0;
  EXPECT_TRUE(bounds.has_any());
  bounds = {};
  bounds.uv = 0.25;
  EXPECT_TRUE(bounds.has_any());
  bounds.normal_degrees = 3.0;
  format::MeshRecord mesh{};
  for (const std::uint32_t sets : {0U, 1U, 4U}) {
    for (const auto mode : {format::NormalMode::kNone, format::NormalMode::kFlat, format::NormalMode::kStored}) {
      mesh.uv_set_count = sets;
      mesh.normal_mode = mode;
      const AttributeBounds own = bounds_for(bounds, mesh);
      EXPECT_EQ(own.uv, sets > 0 ? 0.25 : double{format::kInfiniteError});
      EXPECT_EQ(own.normal_degrees, mode != format::NormalMode::kNone ? 3.0 : double{format::kInfiniteError});
    }
  }
  format::GroupRecord group{};
  group.normal_deviation = 3.0F;
  group.uv_deviation = 0.25F;
  EXPECT_TRUE(is_within(bounds, group)) << "a bound is kept where it is met";
  group.normal_deviation = std::nextafter(3.0F, 4.0F);
  EXPECT_FALSE(is_within(bounds, group));
  group.normal_deviation = 0.0F;
  group.uv_deviation = std::nextafter(0.25F, 1.0F);
  EXPECT_FALSE(is_within(bounds, group));
}

// The root's sphere, and the largest error of a group that may pass, grown once.
TEST(Traversal, TheFarBoundIsTheRootsSphereAndTheCoarsestError) {
  RandomSource random(205);
  const TestTables owned = two_meshes(random, 40);
  const SelectTables tables = owned.view();
  std::vector<float> errors;
  for (const format::GroupRecord& group : tables.groups) errors.push_back(group.error);
  for (const format::MeshRecord& mesh : tables.meshes) {
    float coarsest = 0.0F;
    std::uint32_t roots = 0, root = format::kNone;
    for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
      if (errors[g] < format::kInfiniteError) {
        coarsest = std::max(coarsest, errors[g]);
      } else {
        ++roots;
        root = g;
      }
    }
    const FarBound found = find_far_bound(tables, mesh, errors);
    EXPECT_EQ(found.bound.error, coarser_error(coarsest));
    EXPECT_EQ(found.bound.radius, tables.nodes[mesh.first_node].radius);
    EXPECT_EQ(found.only_root, roots == 1 ? root : format::kNone);
    // The first group, the last, two, and none.
    std::vector<float> changed(errors.size(), 1.0F);
    EXPECT_EQ(find_far_bound(tables, mesh, changed).only_root, format::kNone);
    for (const std::uint32_t only : {mesh.first_group, mesh.first_group + mesh.group_count - 1}) {
      changed.assign(errors.size(), 1.0F);
      changed[only] = format::kInfiniteError;
      EXPECT_EQ(find_far_bound(tables, mesh, changed).only_root, only);
      changed[mesh.first_group + 1] = format::kInfiniteError;
      EXPECT_EQ(find_far_bound(tables, mesh, changed).only_root, format::kNone);
    }
  }
}

TEST(Traversal, AMeshWithoutNodesDrawsNothingThroughThem) {
  RandomSource random(206);
  TestTables tables = two_meshes(random, 20);
  tables.meshes[0].node_count = 0;
  for (const ClusterInstance& d : select_bvh(tables.view(), Camera{}, 0.0)) EXPECT_GE(d.instance.value, 2U);
}

// Whatever error is allowed, and whatever their other numbers say: terminal groups never pass, and their members are
// drawn.
TEST(Traversal, AtAnyErrorTheRootsAreDrawn) {
  RandomSource random(207);
  TestTables tables = two_meshes(random, 40);
  for (format::GroupRecord& group : tables.groups) {
    if ((group.flags & format::kGroupTerminal) != 0) group.quadric_error = 0.0F;
  }
  for (std::uint32_t m = 0; m < 2; ++m) {
    for (const CutError by : {CutError::kSelection, CutError::kQuadric}) {
      for (const double error : {1e30, static_cast<double>(format::kInfiniteError), HUGE_VAL}) {
        const UniformCut cut = select_uniform(tables.view(), MeshId(m), error, by);
        ASSERT_FALSE(cut.clusters.empty());
        for (const ClusterId id : cut.clusters)
          EXPECT_NE(tables.groups[tables.clusters[id.value].coarser_group].flags & format::kGroupTerminal, 0);
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::run
