// SPDX-License-Identifier: GPL-3.0-or-later
// Culling bounds are as tight as their integers allow: against whole numbers, and with eleven more bits.
#include "builder/hierarchy/culling_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "builder/hierarchy/bvh.h"
#include "builder/hierarchy/enclosing_ball.h"
#include "builder/hierarchy/lod_bounds.h"
#include "builder/hierarchy/margins.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::RandomSource;
using Vec3l = glm::vec<3, long double>;

struct FacetCluster {
  LodDag dag;
  DagCluster cluster;
};

void add_facet(RandomSource& random, const Vec3d& n, FacetCluster& out) {
  const Vec3d u = glm::normalize(glm::cross(n, random.direction())), v = glm::cross(n, u);
  const Vec3d at = random.in_cube(1e6);
  const double size = random.log_between(1e3, 3e6);
  const auto first = static_cast<std::uint8_t>(out.dag.vertex_position.size());
  for (const Vec3d& p : {at, at + u * size, at + v * size}) out.dag.vertex_position.push_back(Vec3i(p));
  out.dag.triangles.push_back({first, static_cast<std::uint8_t>(first + 1), static_cast<std::uint8_t>(first + 2)});
  out.cluster.vertex_count += 3;
  out.cluster.triangle_count += 1;
}

/// Triangles whose normals lean by up to `lean` from an axis, as far as the grid lets them.
FacetCluster facets_around(RandomSource& random, const Vec3d& axis, double lean, std::uint32_t count) {
  FacetCluster out;
  for (std::uint32_t t = 0; t < count; ++t) add_facet(random, glm::normalize(axis + lean * random.direction()), out);
  return out;
}

std::vector<Vec3l> normals_of(const FacetCluster& facets) {
  std::vector<Vec3l> normals;
  for (const auto& t : facets.dag.triangles) {
    const Vec3l a(facets.dag.vertex_position[t[0]]);
    const Vec3l n =
        glm::cross(Vec3l(facets.dag.vertex_position[t[1]]) - a, Vec3l(facets.dag.vertex_position[t[2]]) - a);
    const long double length = std::sqrt(glm::dot(n, n));
    if (length > 0.0L) normals.push_back(n / length);
  }
  return normals;
}

// The axis is the mean of the normals to the nearest 127th, and the cutoff the least whole number that culls backs
// alone: L · sin of the angle to the farthest normal, L being the length of the axis as it is stored.
TEST(CullingBounds, TheConeIsTheNarrowestThatItsBytesCanSay) {
  RandomSource random(131);
  int cones = 0, none = 0;
  for (int round = 0; round < 20000; ++round) {
    Vec3d axis = random.direction();
    if (round % 5 == 0) {
      axis = Vec3d(0.0);
      axis[round / 5 % 3] = round % 2 == 0 ? 1.0 : -1.0;
    }
    const FacetCluster facets = facets_around(random, axis, random.log_between(1e-3, 2.0), 1 + random.below(12));
    const Hierarchy::Cone cone = normal_cone(facets.dag, facets.cluster);
    const std::vector<Vec3l> normals = normals_of(facets);
    Vec3l sum(0.0L);
    for (const Vec3l& n : normals) sum += n;
    const Vec3l mean = sum / std::sqrt(glm::dot(sum, sum));
    Vec3l stored;
    bool is_near_half = false;
    for (int k = 0; k < 3; ++k) {
      stored[k] = std::floor(mean[k] * 127.0L + 0.5L);
      is_near_half |= std::fabs(mean[k] * 127.0L + 0.5L - std::round(mean[k] * 127.0L + 0.5L)) < 1e-9L;
    }
    if (is_near_half) continue;
    const long double length = std::sqrt(glm::dot(stored, stored));
    long double cosine = 1.0L;
    for (const Vec3l& n : normals) cosine = std::min(cosine, glm::dot(n, stored) / length);
    const long double needed = length * std::sqrt(std::max(0.0L, 1.0L - cosine * cosine));
    if (cosine < -1e-9L || needed > 126.0L) {
      ++none;
      ASSERT_EQ(cone.cutoff, 127) << "seed 131, round " << round;
      continue;
    }
    if (cosine < 1e-9L) continue;
    ++cones;
    for (int k = 0; k < 3; ++k) ASSERT_EQ(cone.axis[k], static_cast<int>(stored[k])) << "seed 131, round " << round;
    ASSERT_GE(cone.cutoff, needed) << "seed 131, round " << round;
    // One less would not do, but for a millionth, and what a cosine next to 1 loses of its sine: √(2 · 1e-12) · 127.
    ASSERT_LT(cone.cutoff - 1, needed + 2e-6L + (needed < 0.01L ? 2e-4L : 2e-8L / needed))
        << "seed 131, round " << round;
  }
  EXPECT_GT(cones, 10000);
  EXPECT_GT(none, 500);
}

TEST(CullingBounds, WhereThereIsNoConeNothingIsSaidOfItsAxis) {
  RandomSource random(132);
  int none = 0;
  for (int round = 0; round < 4000; ++round) {
    // Two normals that lean to either side by 80 to 93 degrees: at last the cutoff would be 127 or more.
    const Vec3d axis = random.direction(), side = glm::normalize(glm::cross(axis, random.direction()));
    const double angle = random.between(1.40, 1.62);
    FacetCluster facets;
    for (const double sign : {1.0, -1.0})
      add_facet(random, axis * std::cos(angle) + side * (sign * std::sin(angle)), facets);
    const Hierarchy::Cone cone = normal_cone(facets.dag, facets.cluster);
    if (cone.cutoff != 127) continue;
    ++none;
    for (const std::int8_t c : cone.axis) ASSERT_EQ(c, 0) << "seed 132, round " << round;
  }
  EXPECT_GT(none, 1000);
  EXPECT_LT(none, 3900);
}

// The finest unit of a power of two in which every centre is within 32766 and every radius within 65533.
TEST(CullingBounds, TheUnitIsTheFinestThatHoldsEverySphere) {
  RandomSource random(133);
  const auto sphere = [](float x, float y, float z, float radius) { return Hierarchy::Sphere{{x, y, z}, radius}; };
  for (int log2 = -100; log2 <= 90; log2 += 5) {
    const auto unit = static_cast<float>(std::ldexp(1.0, log2));
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {-1.0F, 1.0F}) {
        Hierarchy::Sphere one = sphere(0, 0, 0, unit);
        one.center[axis] = sign * 32766.0F * unit;
        EXPECT_EQ(choose_sphere_log2(std::vector{sphere(unit, 0, 0, 0), one}), log2) << axis;
        one.center[axis] = std::nextafter(one.center[axis], sign * HUGE_VALF);
        EXPECT_EQ(choose_sphere_log2(std::vector{one, sphere(unit, 0, 0, 0)}), log2 + 1) << axis;
      }
    }
    EXPECT_EQ(choose_sphere_log2(std::vector{sphere(unit, 0, 0, 65533.0F * unit)}), log2);
    EXPECT_EQ(choose_sphere_log2(std::vector{sphere(unit, 0, 0, std::nextafter(65533.0F * unit, HUGE_VALF))}),
              log2 + 1);
  }
  EXPECT_EQ(choose_sphere_log2({}), format::kMinSphereLog2);
  const float most = std::numeric_limits<float>::max();
  EXPECT_EQ(choose_sphere_log2(std::vector{sphere(most, 0, 0, most)}), format::kMaxSphereLog2);
}

// In whole units: the centre the nearest, and the radius the least that holds the sphere there.
TEST(CullingBounds, ASnappedSphereIsTheLeastInWholeUnits) {
  RandomSource random(134);
  for (int round = 0; round < 5000; ++round) {
    const int log2 = static_cast<int>(random.below(100)) - 60;
    const double unit = std::ldexp(1.0, log2);
    Hierarchy::Sphere sphere;
    for (float& c : sphere.center) c = static_cast<float>(random.between(-32000.0, 32000.0) * unit);
    sphere.radius = static_cast<float>(random.log_between(1e-3, 60000.0) * unit);
    if (round % 4 == 0) {
      for (float& c : sphere.center) c = static_cast<float>(std::floor(random.between(-100.0, 100.0)) * unit);
      sphere.radius = static_cast<float>(std::ceil(random.between(0.0, 100.0)) * unit);
    }
    const Hierarchy::Sphere snapped = snap_sphere(sphere, log2);
    Vec3l off;
    for (int k = 0; k < 3; ++k) {
      const long double units = static_cast<long double>(sphere.center[k]) / unit;
      ASSERT_EQ(static_cast<long double>(snapped.center[k]) / unit, std::floor(units + 0.5L)) << "seed 134";
      off[k] = units - std::floor(units + 0.5L);
    }
    const long double needed = std::sqrt(glm::dot(off, off)) + static_cast<long double>(sphere.radius) / unit;
    const long double radius = static_cast<long double>(snapped.radius) / unit;
    ASSERT_EQ(radius, std::floor(radius));
    ASSERT_GE(radius, needed) << "seed 134, round " << round;
    // A sphere of whole units needs a unit more, for what rounding might have lost.
    ASSERT_LE(radius - 1.0L, needed * (1.0L + 0x1p-47L)) << "seed 134, round " << round;
  }
}

TEST(CullingBounds, ASphereWithoutVerticesIsNothing) {
  const Hierarchy::Sphere none = culling_sphere({}, {}, {});
  EXPECT_EQ(none.radius, 0.0F);
}

// The least float that is not below, of every size, and the largest error where there is none.
TEST(CullingBounds, FloatsAreRoundedUpAndNoFarther) {
  RandomSource random(135);
  for (int round = 0; round < 20000; ++round) {
    const double value = random.log_between(1e-40, 1e38);
    const float above = float_above(value);
    ASSERT_GE(double{above}, value);
    ASSERT_LT(double{std::nextafter(above, 0.0F)}, value) << value;
    ASSERT_EQ(float_above(double{above}), above) << "a float is itself";
  }
  EXPECT_EQ(float_above(0.0), 0.0F);
  EXPECT_EQ(float_above(1e39), format::kInfiniteError);
  EXPECT_EQ(float_above(std::nan("")), format::kInfiniteError);
  EXPECT_EQ(float_above(std::nextafter(double{format::kInfiniteError}, 0.0)), format::kInfiniteError);
  const float below = std::nextafter(format::kInfiniteError, 0.0F);
  EXPECT_EQ(float_above(double{below}), below);
}

// An error over a finer one grows by 2^-18; the own one counts where it is larger, within what is stored at all.
TEST(CullingBounds, AnErrorIsTheLargerOfItsOwnAndTheFinerGrown) {
  RandomSource random(136);
  for (int round = 0; round < 5000; ++round) {
    const auto finer = static_cast<float>(random.log_between(1e-25, 1e30));
    const double own = double{finer} * random.log_between(0.5, 2.0), grown = double{finer} * (1.0 + 0x1p-18);
    const float expected = float_above(std::max(own, grown));
    ASSERT_EQ(grow_error(own, finer), expected) << "seed 136, round " << round;
  }
  EXPECT_EQ(grow_error(0.0, 0.0F), 0.0F);
  EXPECT_EQ(grow_error(std::nan(""), 0.0F), 0.0F);
  EXPECT_EQ(grow_error(1e-300, 0.0F), 0x1p-100F);
  EXPECT_EQ(grow_error(0x1p-100, 0.0F), 0x1p-100F);
  EXPECT_EQ(grow_error(0x1p-99, 0.0F), 0x1p-99F);
  EXPECT_EQ(grow_error(0x1p120, 0.0F), 0x1p120F);
  EXPECT_EQ(grow_error(0x1p121, 0.0F), 0x1p120F);
  EXPECT_EQ(grow_error(std::numeric_limits<double>::infinity(), 0.0F), 0x1p120F);
  EXPECT_EQ(grow_error(-1.0, 1.0F), float_above(1.0 + 0x1p-18));
}

// Along one axis alone, whichever it is, two points have their middle.
TEST(CullingBounds, TwoPointsOnAnAxisHaveTheirMiddle) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double size : {1e-30, 1.0, 1e30}) {
      Ball low, high;
      high.center[axis] = 2.0 * size;
      const Ball ball = enclosing_ball(std::vector{low, high});
      EXPECT_NEAR(ball.center[axis], size, 1e-12 * size);
      EXPECT_NEAR(ball.radius, size, 1e-12 * size);
    }
  }
}

// Where a node has not room for all levels, the coarser ones, which are asked first, lie nearer to the root.
TEST(CullingBounds, CoarserLevelsLieNearerToTheRoot) {
  constexpr std::uint32_t kLevels = 30;
  std::vector<Hierarchy::Sphere> spheres(kLevels, {{0.0F, 0.0F, 0.0F}, 1.0F});
  std::vector<float> errors(kLevels, 1.0F);
  std::vector<std::uint32_t> levels(kLevels), depth(kLevels, 0);
  for (std::uint32_t g = 0; g < kLevels; ++g) levels[g] = (7 * g) % kLevels;
  const std::vector<format::NodeRecord> nodes = build_bvh(spheres, errors, levels);
  std::vector<std::uint32_t> depth_of_node(nodes.size(), 0);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].child_count == 0) depth[levels[nodes[n].first]] = depth_of_node[n];
    for (std::uint32_t c = 0; c < nodes[n].child_count; ++c) depth_of_node[nodes[n].first + c] = depth_of_node[n] + 1;
  }
  for (std::uint32_t level = 1; level < kLevels; ++level) EXPECT_LE(depth[level], depth[level - 1]) << level;
  EXPECT_LT(depth[kLevels - 1], depth[0]);
}

}  // namespace
}  // namespace meshlode::builder
