// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds nest in exact arithmetic (I4), contain the geometry they stand for, and cull nothing that can be seen.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstring>
#include <vector>

#include "builder/hierarchy/bvh.h"
#include "builder/hierarchy/culling_bounds.h"
#include "builder/hierarchy/hierarchy.h"
#include "builder/hierarchy/lod_bounds.h"
#include "builder/hierarchy/margins.h"
#include "run/read/nesting.h"
#include "run/select/random_dag.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using test::RandomDag;
using test::RandomSource;

static_assert(kSphereGrowth > run::kNestingRadiusMargin && kCenterGrowth > run::kNestingCenterMargin &&
              kErrorGrowth > run::kNestingErrorMargin);

run::StoredBound bound(const Hierarchy::Sphere& s, float error) {
  return {{s.center[0], s.center[1], s.center[2]}, s.radius, error};
}

// |co - ci| + ri <= ro without any rounding.
bool contains_exactly(const run::StoredBound& outer, const run::StoredBound& inner) {
  const Rational room = Rational(outer.radius) - Rational(inner.radius);
  if (room < 0) return false;
  Rational distance2 = 0;
  for (int i = 0; i < 3; ++i) {
    const Rational d = Rational(outer.center[i]) - Rational(inner.center[i]);
    distance2 += d * d;
  }
  return distance2 <= room * room;
}

std::vector<RandomDag> make_dags(std::uint64_t seed) {
  RandomSource random(seed);
  std::vector<RandomDag> dags;
  for (const int log2 : {-40, -20, 10}) {
    for (const std::uint32_t leaves : {1U, 3U, 120U}) {
      test::RandomDagOptions options;
      options.grid_log2 = log2;
      options.leaf_clusters = leaves;
      dags.push_back(test::make_random_dag(random, options));
    }
  }
  return dags;
}

TEST(Hierarchy, SpheresAndErrorsNestAlongTheDagExactlyAndWithTheMargin) {
  for (const RandomDag& d : make_dags(41)) {
    const Hierarchy h = build_hierarchy(d.dag, d.mesh);
    ASSERT_EQ(h.group_spheres.size(), d.dag.groups.size());
    for (std::size_t c = 0; c < d.dag.clusters.size(); ++c) {
      const DagCluster& cluster = d.dag.clusters[c];
      const std::uint32_t g = cluster.coarser_group.value;
      const run::StoredBound coarser = bound(h.group_spheres[g], h.group_errors[g]);
      const run::StoredBound culling = bound(h.cluster_spheres[c], 0.0F);
      if (!cluster.own_group.is_valid()) {
        EXPECT_TRUE(contains_exactly(coarser, culling));
        EXPECT_TRUE(run::is_sphere_nested(coarser, culling));
        continue;
      }
      const std::uint32_t own = cluster.own_group.value;
      const run::StoredBound finer = bound(h.group_spheres[own], h.group_errors[own]);
      EXPECT_TRUE(contains_exactly(coarser, finer));
      EXPECT_TRUE(run::is_nested(coarser, finer));
      EXPECT_TRUE(contains_exactly(finer, culling)) << "the sphere of a group holds what is made from it";
    }
    for (std::size_t g = 0; g < d.dag.groups.size(); ++g) {
      if (d.dag.groups[g].is_terminal) {
        EXPECT_EQ(h.group_errors[g], format::kInfiniteError);
      } else {
        EXPECT_GE(double{h.group_errors[g]}, d.dag.groups[g].error);
        EXPECT_TRUE(h.group_errors[g] == 0.0F || h.group_errors[g] >= kMinStoredError);
        EXPECT_LT(h.group_errors[g], format::kInfiniteError);
      }
    }
  }
}

TEST(Hierarchy, NestingCheckFailsWhenARadiusOrErrorIsNudged) {
  const Hierarchy::Sphere inner{{0.3F, -7.0F, 2.0F}, 1.5F};
  const std::vector<Hierarchy::Sphere> all{inner, {{4.0F, 1.0F, 0.0F}, 0.25F}};
  const run::StoredBound outer = bound(enclose_spheres(all), grow_error(0.0, 1.0F));
  for (const Hierarchy::Sphere& s : all) EXPECT_TRUE(run::is_nested(outer, bound(s, 1.0F)));
  run::StoredBound smaller = outer;
  smaller.radius *= 1.0F - 0x1p-20F;
  EXPECT_FALSE(run::is_nested(smaller, bound(all[0], 1.0F)) && run::is_nested(smaller, bound(all[1], 1.0F)));
  run::StoredBound less = outer;
  less.error = std::nextafter(1.0F, 2.0F);
  EXPECT_FALSE(run::is_nested(less, bound(inner, 1.0F)));
}

TEST(Hierarchy, ErrorsGrowWhereTheyAreNotZero) {
  EXPECT_EQ(grow_error(0.0, 0.0F), 0.0F);
  EXPECT_EQ(grow_error(-1.0, 0.0F), 0.0F);
  EXPECT_EQ(grow_error(std::nan(""), 0.0F), 0.0F);
  EXPECT_EQ(grow_error(0.5, 0.0F), 0.5F);
  EXPECT_EQ(grow_error(1e-60, 0.0F), kMinStoredError);
  EXPECT_GE(double{grow_error(0.1, 0.0F)}, 0.1);  // rounded up
  EXPECT_GE(double{grow_error(0.0, 1.0F)}, 1.0 + kErrorGrowth);
  EXPECT_EQ(grow_error(3.0, 1.0F), 3.0F);
  EXPECT_EQ(grow_error(HUGE_VAL, 1.0F), kMaxStoredError);
  EXPECT_GT(grow_error(HUGE_VAL, kMaxStoredError), kMaxStoredError);
}

TEST(Hierarchy, GroupSphereContainsAllGeometryBelowIt) {
  for (const RandomDag& d : make_dags(42)) {
    const Hierarchy h = build_hierarchy(d.dag, d.mesh);
    // Groups come coarse to fine: hand the list of groups above down to where the geometry is.
    std::vector<std::vector<std::uint32_t>> above(d.dag.groups.size());
    for (std::uint32_t g = 0; g < d.dag.groups.size(); ++g) {
      above[g].push_back(g);
      std::sort(above[g].begin(), above[g].end());
      above[g].erase(std::unique(above[g].begin(), above[g].end()), above[g].end());
      const DagGroup& group = d.dag.groups[g];
      for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
        const DagCluster& cluster = d.dag.clusters[c];
        if (cluster.own_group.is_valid()) {
          auto& list = above[cluster.own_group.value];
          list.insert(list.end(), above[g].begin(), above[g].end());
        }
        for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
          const Vec3d p = d.mesh.grid.decode(d.dag.vertex_position[v]);
          for (const std::uint32_t a : above[g]) {
            const Hierarchy::Sphere& s = h.group_spheres[a];
            if (cluster.own_group.is_valid() && a == g) continue;  // its own group's sphere answers for it
            ASSERT_LE(glm::length(p - center_of(s)), double{s.radius});
          }
        }
      }
    }
  }
}

TEST(Hierarchy, CullingSphereIsTightAroundTheDecodedVertices) {
  RandomSource random(43);
  for (int i = 0; i < (test::kIsSanitized ? 100 : 400); ++i) {
    format::PositionGrid grid;
    grid.log2 = std::vector<int>{-40, -20, 0, 10}[random.below(4)];
    grid.mantissa = 1 + 2 * random.below(4);
    LodDag dag;
    DagCluster cluster;
    cluster.vertex_count = 1 + random.below(256);
    const double size = random.log_between(1.0, 4e6);
    const Vec3d middle = random.in_cube(4e6);
    for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
      dag.vertex_position.push_back(Vec3i(middle + random.in_cube(size)));
    }
    const Hierarchy::Sphere s = culling_sphere(dag, cluster, grid);
    double farthest = 0.0;
    for (const Vec3i& q : dag.vertex_position) {
      const Vec3d p = grid.decode(q);
      Rational distance2 = 0, float_distance2 = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const Rational d = Rational(p[axis]) - Rational(s.center[axis]);
        const Rational f = Rational(static_cast<float>(p[axis])) - Rational(s.center[axis]);
        distance2 += d * d;
        float_distance2 += f * f;
      }
      ASSERT_LE(distance2, Rational(s.radius) * Rational(s.radius));
      ASSERT_LE(float_distance2, Rational(s.radius) * Rational(s.radius));
      farthest = std::max(farthest, glm::length(p - center_of(s)));
    }
    EXPECT_LE(double{s.radius}, farthest * (1.0 + 1e-6) + 1e-7 * glm::length(center_of(s)));
  }
}

struct Patch {
  LodDag dag;
  DagCluster cluster;
};

// A fan of triangles around an axis, tilted by up to `tilt`, with duplicates and triangles without area among them.
Patch make_patch(RandomSource& random, double tilt) {
  Patch p;
  const Vec3d axis = random.direction();
  const Vec3d x = glm::normalize(glm::cross(axis, random.direction())), y = glm::cross(axis, x);
  const std::uint32_t count = 1 + random.below(40);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Vec3d n = glm::normalize(axis + std::tan(random.unit() * tilt) * (random.chance(0.5) ? x : -y));
    const Vec3d u = glm::normalize(glm::cross(n, random.direction())), v = glm::cross(n, u);
    const Vec3d at = random.in_cube(1e6);
    const double size = random.log_between(3.0, 1e6);
    const std::uint8_t first = static_cast<std::uint8_t>(3 * t);
    p.dag.vertex_position.push_back(Vec3i(at));
    p.dag.vertex_position.push_back(Vec3i(at + u * size));
    const double width = random.chance(0.1) ? 0.0 : size * random.log_between(1e-4, 1.0);
    p.dag.vertex_position.push_back(Vec3i(at + v * width));
    p.dag.triangles.push_back({first, static_cast<std::uint8_t>(first + 1), static_cast<std::uint8_t>(first + 2)});
  }
  p.cluster.vertex_count = 3 * count;
  p.cluster.triangle_count = count;
  return p;
}

TEST(Hierarchy, NormalConeNeverCullsAVisibleTriangle) {
  RandomSource random(44);
  std::uint64_t culled = 0;
  for (int i = 0; i < 3000; ++i) {
    const Patch p = make_patch(random, random.between(0.0, 2.0));
    const Hierarchy::Cone cone = normal_cone(p.dag, p.cluster);
    ASSERT_GE(cone.cutoff, 0);
    if (cone.cutoff == 127) continue;
    const Vec3d axis = Vec3d(cone.axis[0], cone.axis[1], cone.axis[2]) / 127.0;
    for (int n = 0; n < 60; ++n) {
      // Views near the border: at the angle whose cosine is the cutoff.
      const Vec3d along = glm::normalize(axis);
      const Vec3d side = glm::normalize(glm::cross(along, random.direction()));
      const double c = std::min(1.0, cone.cutoff / 127.0 / glm::length(axis) * (1.0 + random.between(-0.01, 0.05)));
      const Vec3d view = along * c + side * std::sqrt(1.0 - c * c);
      if (!(glm::dot(view, axis) >= cone.cutoff / 127.0)) continue;
      ++culled;
      for (const auto& t : p.dag.triangles) {
        const Vec3d a(p.dag.vertex_position[t[0]]), b(p.dag.vertex_position[t[1]]), d(p.dag.vertex_position[t[2]]);
        const Vec3d normal = glm::cross(b - a, d - a);
        ASSERT_GE(glm::dot(view, normal), -1e-9 * glm::length(normal)) << "seed 44, patch " << i;
      }
    }
  }
  EXPECT_GT(culled, 10000U);
}

TEST(Hierarchy, NormalConeIsNarrowForAFlatPatchAndNoneForAClosedOne) {
  Patch flat;
  flat.dag.vertex_position = {{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}, {50, 50, 0}};
  flat.dag.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 4, 2}};  // the last one has no area
  flat.cluster.vertex_count = 5;
  flat.cluster.triangle_count = 3;
  const Hierarchy::Cone cone = normal_cone(flat.dag, flat.cluster);
  EXPECT_EQ(cone.axis[2], 127);
  EXPECT_LE(cone.cutoff, 1);
  Patch closed = flat;
  closed.dag.triangles = {{0, 1, 2}, {0, 2, 1}, {0, 4, 2}};
  EXPECT_EQ(normal_cone(closed.dag, closed.cluster).cutoff, 127);
  closed.dag.triangles = {{0, 4, 2}, {0, 0, 1}, {4, 2, 0}};  // nothing has area
  EXPECT_EQ(normal_cone(closed.dag, closed.cluster).cutoff, 127);
}

TEST(Hierarchy, BvhHasEachGroupInOneLeafAndNestsItsChildren) {
  for (const RandomDag& d : make_dags(45)) {
    const Hierarchy h = build_hierarchy(d.dag, d.mesh);
    const auto bound_of_node = [&](std::size_t n) { return run::bound_of(h.nodes[n]); };
    std::vector<int> parents(h.nodes.size(), 0), leaves(d.dag.groups.size(), 0);
    for (std::size_t n = 0; n < h.nodes.size(); ++n) {
      const format::NodeRecord& node = h.nodes[n];
      if (node.child_count == 0) {
        ASSERT_LT(node.first, leaves.size());
        ++leaves[node.first];
        const run::StoredBound leaf = bound_of_node(n);
        const run::StoredBound group = bound(h.group_spheres[node.first], h.group_errors[node.first]);
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the same bits are promised.
        EXPECT_EQ(std::memcmp(&leaf, &group, sizeof(leaf)), 0);
        continue;
      }
      ASSERT_GE(node.child_count, 2U);
      ASSERT_LE(node.child_count, format::kBvhWidth);
      ASSERT_GT(node.first, n);
      ASSERT_LE(std::size_t{node.first} + node.child_count, h.nodes.size());
      bool is_infinite = false;
      for (std::uint32_t c = node.first; c < node.first + node.child_count; ++c) {
        ++parents[c];
        is_infinite |= h.nodes[c].error >= format::kInfiniteError;
        EXPECT_TRUE(contains_exactly(bound_of_node(n), bound_of_node(c)));
        EXPECT_TRUE(run::is_nested(bound_of_node(n), bound_of_node(c)));
      }
      EXPECT_EQ(is_infinite, node.error >= format::kInfiniteError);
    }
    for (std::size_t n = 0; n < parents.size(); ++n) EXPECT_EQ(parents[n], n == 0 ? 0 : 1);
    for (const int count : leaves) EXPECT_EQ(count, 1);
  }
}

TEST(Hierarchy, ClusterSpheresHoldTheirVerticesInWholeUnits) {
  for (const RandomDag& d : make_dags(47)) {
    const Hierarchy h = build_hierarchy(d.dag, d.mesh);
    for (std::size_t c = 0; c < d.dag.clusters.size(); ++c) {
      const DagCluster& cluster = d.dag.clusters[c];
      const Hierarchy::Sphere& sphere = h.cluster_spheres[c];
      for (std::uint32_t v = cluster.first_vertex; v < cluster.first_vertex + cluster.vertex_count; ++v) {
        const Vec3d p = d.mesh.grid.decode(d.dag.vertex_position[v]);
        Rational distance2 = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const Rational away = Rational(p[axis]) - Rational(sphere.center[axis]);
          distance2 += away * away;
        }
        ASSERT_LE(distance2, Rational(sphere.radius) * Rational(sphere.radius));
      }
    }
  }
}

std::vector<std::uint32_t> groups_below(const std::vector<format::NodeRecord>& nodes, std::uint32_t node) {
  if (nodes[node].child_count == 0) return {nodes[node].first};
  std::vector<std::uint32_t> groups;
  for (std::uint32_t c = 0; c < nodes[node].child_count; ++c) {
    const std::vector<std::uint32_t> below = groups_below(nodes, nodes[node].first + c);
    groups.insert(groups.end(), below.begin(), below.end());
  }
  return groups;
}

// Groups along a line, which is the longest axis of any two of them: each node's children follow each other on it.
TEST(Hierarchy, BvhKeepsNeighboursTogetherAlongAnyAxisInAnyOrder) {
  RandomSource random(48);
  constexpr std::uint32_t kCount = 300;
  for (int axis = 0; axis < 3; ++axis) {
    for (const std::uint32_t stride : {1U, kCount - 1, 7U, 101U}) {  // forwards, backwards, mixed
      std::vector<Hierarchy::Sphere> spheres(kCount);
      for (std::uint32_t g = 0; g < kCount; ++g) {
        for (float& c : spheres[g].center) c = static_cast<float>(random.between(-1.0, 1.0));
        spheres[g].center[axis] = 10.0F * static_cast<float>(g * stride % kCount) - 1000.0F;
        spheres[g].radius = 1.0F;
      }
      const std::vector<format::NodeRecord> nodes =
          build_bvh(spheres, std::vector<float>(kCount, 1.0F), std::vector<std::uint32_t>(kCount, 3));
      for (const format::NodeRecord& node : nodes) {
        std::vector<std::array<float, 2>> ranges;
        for (std::uint32_t c = 0; c < node.child_count; ++c) {
          std::array<float, 2> range{HUGE_VALF, -HUGE_VALF};
          for (const std::uint32_t g : groups_below(nodes, node.first + c)) {
            range = {std::min(range[0], spheres[g].center[axis]), std::max(range[1], spheres[g].center[axis])};
          }
          ranges.push_back(range);
        }
        std::sort(ranges.begin(), ranges.end());
        for (std::size_t i = 1; i < ranges.size(); ++i) {
          ASSERT_LT(ranges[i - 1][1], ranges[i][0]) << "axis " << axis << ", stride " << stride;
        }
      }
    }
  }
}

// A group that never passes keeps what is above it open: below that there is one closed subtree for each level.
TEST(Hierarchy, TerminalGroupsHoldNothingElseOpen) {
  RandomSource random(49);
  for (const std::uint32_t count : {20U, 300U, 2000U}) {
    constexpr std::uint32_t kLevels = 5;
    std::vector<Hierarchy::Sphere> spheres(count);
    std::vector<float> errors(count);
    std::vector<std::uint32_t> levels(count);
    for (std::uint32_t g = 0; g < count; ++g) {
      const Vec3d c = random.in_cube(100.0);
      spheres[g] = {{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)}, 1.0F};
      levels[g] = g % kLevels;
      errors[g] = random.chance(0.1) ? format::kInfiniteError : static_cast<float>(levels[g] + 1);
    }
    const std::vector<format::NodeRecord> nodes = build_bvh(spheres, errors, levels);
    std::vector<std::uint32_t> closed_of_level(kLevels, 0), open{0};
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      if (nodes[at].error >= format::kInfiniteError) {
        for (std::uint32_t c = 0; c < nodes[at].child_count; ++c) open.push_back(nodes[at].first + c);
        continue;
      }
      const std::vector<std::uint32_t> groups = groups_below(nodes, at);
      for (const std::uint32_t g : groups) EXPECT_EQ(levels[g], levels[groups[0]]);
      ++closed_of_level[levels[groups[0]]];
    }
    for (const std::uint32_t closed : closed_of_level) EXPECT_EQ(closed, 1U) << count << " groups";
  }
}

TEST(Hierarchy, IsEmptyForAnEmptyDag) {
  const Hierarchy h = build_hierarchy(LodDag{}, PreparedMesh{});
  EXPECT_TRUE(h.nodes.empty());
  EXPECT_TRUE(h.group_spheres.empty());
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(Hierarchy, DoesNotDependOnTheNumberOfThreads) {
  RandomSource random(46);
  test::RandomDagOptions options;
  options.leaf_clusters = 2000;
  const RandomDag d = test::make_random_dag(random, options);
  Hierarchy one, two;
  tbb::task_arena(1).execute([&] { one = build_hierarchy(d.dag, d.mesh); });
  tbb::task_arena(2).execute([&] { two = build_hierarchy(d.dag, d.mesh); });
  EXPECT_TRUE(same_bytes(one.group_spheres, two.group_spheres));
  EXPECT_TRUE(same_bytes(one.group_errors, two.group_errors));
  EXPECT_TRUE(same_bytes(one.cluster_spheres, two.cluster_spheres));
  EXPECT_TRUE(same_bytes(one.cluster_cones, two.cluster_cones));
  EXPECT_TRUE(same_bytes(one.nodes, two.nodes));
}

}  // namespace
}  // namespace meshlode::builder
