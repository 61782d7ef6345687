// SPDX-License-Identifier: GPL-3.0-or-later
// The tree against brute force: what it finds is the nearest up to the rounding of floats, never nearer than the truth.
#include "builder/deviation/surface_tree.h"
#include "builder/deviation/source_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "builder/deviation/capsules.h"
#include "builder/deviation/surfaces.h"
#include "builder/odd_shapes.h"

namespace meshlode::builder {
namespace {

using test::Random;

TEST(SurfaceTree, LeavesThatAreMadeAnswerAsThoseThatAreHeld) {
  Random random(5);
  for (const std::uint32_t count : {1U, 4U, 7U, 64U, 65U, 1500U}) {
    const judge::Surface surface = test::random_soup(random, count, 1.0, 0.1);
    SurfaceTree held, made;
    held.build({surface.positions, surface.triangles});
    made.build({surface.positions, surface.triangles}, SurfaceTree::Leaves::kMade);
    ASSERT_EQ(made.size(), count);
    TreeSlot place{0U};
    for (int i = 0; i < 200; ++i) {
      const Vec3f p = held.to_frame(Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()));
      const SurfaceTree::Hit around = held.look_around(p, place, {}), same_around = made.look_around(p, place, {});
      EXPECT_EQ(around.slot, same_around.slot);
      EXPECT_EQ(around.distance2, same_around.distance2) << "the same bits";
      const SurfaceTree::Hit hit = held.find_nearest(p, around, 0.0F), same = made.find_nearest(p, same_around, 0.0F);
      EXPECT_EQ(hit.slot, same.slot);
      EXPECT_EQ(hit.distance2, same.distance2);
      place = hit.slot;
    }
  }
}

// Whole cuts leave out all points of a source triangle whose corners are near to one triangle of the cut.
TEST(SurfaceTree, WhatLiesBetweenThreePointsIsNoFartherThanTheFarthestOfThem) {
  Random random(6);
  const auto anywhere = [&] { return Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()); };
  for (const auto leaves : {SurfaceTree::Leaves::kHeldIfFew, SurfaceTree::Leaves::kMade}) {
    const judge::Surface surface = test::random_soup(random, 101, 1.0, 0.5);
    SurfaceTree tree;
    tree.build({surface.positions, surface.triangles}, leaves);
    for (std::uint32_t first = 0; first < tree.size(); first += 4) {
      const std::array<Vec3d, 3> corners{anywhere(), anywhere(), anywhere()};
      const std::array<Vec3f, 3> at{tree.to_frame(corners[0]), tree.to_frame(corners[1]), tree.to_frame(corners[2])};
      const SurfaceTree::Hit hit = tree.look_around(at, TreeSlot(first));
      double least2 = std::numeric_limits<double>::infinity();
      for (std::uint32_t slot = first; slot < std::min(first + 4, tree.size()); ++slot) {
        double farthest2 = 0.0;
        for (const Vec3d& p : corners) farthest2 = std::max(farthest2, tree.distance2_at(p, TreeSlot(slot)));
        least2 = std::min(least2, farthest2);
      }
      const double told = std::sqrt(static_cast<double>(hit.distance2)) / tree.scale();
      EXPECT_NEAR(told, std::sqrt(least2), 1e-5);
      for (int i = 0; i < 20; ++i) {
        const double u = random.unit(), v = (1.0 - u) * random.unit();
        const Vec3d between = corners[0] * (1.0 - u - v) + corners[1] * u + corners[2] * v;
        EXPECT_LE(std::sqrt(tree.distance2_at(between, hit.slot)), told + 1e-5);
      }
    }
  }
}

TEST(SurfaceTree, FindsTheNearestTriangleAtEveryScale) {
  Random random(1);
  for (const double scale : {1e-6, 1.0, 1e9}) {
    for (const std::uint32_t count : {1U, 2U, 4U, 5U, 16U, 17U, 63U, 64U, 65U, 300U, 1500U}) {
      const judge::Surface surface = test::random_soup(random, count, scale, 0.1 * scale);
      SurfaceTree tree;
      tree.build({surface.positions, surface.triangles});
      ASSERT_EQ(tree.size(), count);
      for (int i = 0; i < 100; ++i) {
        const Vec3d p = 1.5 * scale * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit());
        const SurfaceTree::Hit hit = tree.find_nearest(tree.to_frame(p), {}, 0.0F);
        ASSERT_TRUE(hit.slot.is_valid());
        const double found = std::sqrt(tree.distance2_at(p, hit.slot));
        const double truth = test::brute_force(surface, p);
        EXPECT_GE(found, truth);
        EXPECT_LE(found, truth + 2e-6 * scale) << "scale " << scale << " count " << count;
      }
    }
  }
}

TEST(SurfaceTree, EveryTriangleHasOnePlace) {
  Random random(2);
  const judge::Surface surface = test::random_soup(random, 1000, 1.0, 0.01);
  SurfaceTree tree;
  tree.build({surface.positions, surface.triangles});
  std::vector<int> count(surface.triangles.size(), 0);
  for (std::uint32_t slot = 0; slot < tree.size(); ++slot) ++count[tree.triangle_at(TreeSlot(slot))];
  for (const int c : count) EXPECT_EQ(c, 1);
}

TEST(SurfaceTree, NeedlesSegmentsAndPointsAreWhatTheyAre) {
  judge::Surface surface;
  surface.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}, {0, 5, 0}, {1, 5, 0}, {2, 5, 0}, {0, 9, 0}};
  surface.triangles = {{0, 1, 2}, {3, 4, 5}, {6, 6, 6}};
  SurfaceTree tree;
  tree.build({surface.positions, surface.triangles});
  const auto distance = [&](const Vec3d& p) {
    return std::sqrt(tree.distance2_at(p, tree.find_nearest(tree.to_frame(p), {}, 0.0F).slot));
  };
  EXPECT_NEAR(distance({0.5, 0, 2}), 2.0, 1e-8);
  EXPECT_NEAR(distance({1.7, 5, 0.25}), 0.25, 1e-12);
  EXPECT_NEAR(distance({0, 9.5, 0}), 0.5, 1e-12);
}

TEST(SurfaceTree, EverythingInOnePlaceIsStillASurface) {
  const judge::Surface surface{{{3, 3, 3}}, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  SurfaceTree tree;
  tree.build({surface.positions, surface.triangles});
  const SurfaceTree::Hit hit = tree.find_nearest(tree.to_frame({3, 3, 7}), {}, 0.0F);
  ASSERT_TRUE(hit.slot.is_valid());
  EXPECT_DOUBLE_EQ(tree.distance2_at({3, 3, 7}, hit.slot), 16.0);
}

TEST(SurfaceTree, AnEarlyStopIsWithinWhatWasAskedFor) {
  const judge::Surface sphere = test::as_surface(lab::make_sphere(16));
  SurfaceTree tree;
  tree.build({sphere.positions, sphere.triangles});
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d p(random.signed_unit(), random.signed_unit(), random.signed_unit());
    const SurfaceTree::Hit nearest = tree.find_nearest(tree.to_frame(p), {}, 0.0F);
    const float enough = 0.04F;
    const SurfaceTree::Hit hit = tree.find_nearest(tree.to_frame(p), {}, enough);
    EXPECT_GE(hit.distance2, nearest.distance2);
    EXPECT_TRUE(hit.distance2 <= enough || hit.distance2 == nearest.distance2);
    // A hint changes nothing but the time.
    const SurfaceTree::Hit hinted =
        tree.find_nearest(tree.to_frame(p), tree.look_around(tree.to_frame(p), TreeSlot(7U), {}), 0.0F);
    EXPECT_EQ(hinted.distance2, nearest.distance2);
  }
}

/// Needles around one vertex, out of every plane, and a second vertex below that has all of the rim, too.
judge::Surface two_fans(std::uint32_t count) {
  const scene::Primitive fan = test::make_fan(count);
  judge::Surface surface = test::as_surface(fan);
  surface.positions.emplace_back(0.1, -0.4, 0.2);
  for (std::uint32_t i = 0; i < count; ++i) surface.triangles.push_back({count + 1, (i + 1) % count + 1, i + 1});
  return surface;
}

TEST(SurfaceTree, CapsulesAroundAHubMissNothing) {
  Random random(4);
  for (const std::uint32_t count : {kHubTriangles - 1, kHubTriangles, 3000U}) {
    const judge::Surface surface = two_fans(count);
    ASSERT_EQ(has_hub(surface.triangles, surface.positions.size()), count >= kHubTriangles);
    SurfaceTree tree, made;
    tree.build({surface.positions, surface.triangles});
    made.build({surface.positions, surface.triangles}, SurfaceTree::Leaves::kMade);
    TreeSlot place{0U};
    for (std::uint32_t i = 0; i < 400; ++i) {
      // Far and near, on the surface, and at its two hubs.
      Vec3d p = (i % 4 == 0 ? 3.0 : 1.0) * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit());
      if (i % 4 == 1) p = surface.positions[i % 8 == 1 ? 0 : count + 1] + 1e-3 * p;
      if (i % 4 == 2)
        p = surface.positions[0] * std::abs(p.x) + surface.positions[1 + i % count] * (1.0 - std::abs(p.x));
      const Vec3f at = tree.to_frame(p);
      const SurfaceTree::Hit hit = tree.find_nearest(at, tree.look_around(at, place, {}), 0.0F);
      ASSERT_TRUE(hit.slot.is_valid());
      EXPECT_EQ(made.find_nearest(at, made.look_around(at, place, {}), 0.0F).slot, hit.slot);
      const double found = std::sqrt(tree.distance2_at(p, hit.slot)), truth = test::brute_force(surface, p);
      EXPECT_GE(found, truth);
      EXPECT_LE(found, truth + 4e-6) << "count " << count << " point " << i;
      place = hit.slot;
    }
  }
}

TEST(SurfaceTree, CapsulesAreCloseAroundNeedles) {
  const judge::Surface fan = test::as_surface(test::make_fan(100000));
  const auto corners = [&](std::size_t t) {
    std::array<Vec3f, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = Vec3f(fan.positions[fan.triangles[t][k]]);
    return at;
  };
  for (const std::size_t first : {0U, 12500U, 40000U}) {  // along an axis and across
    std::array<Capsule, 4> four;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t t = first + 4 * i;
      four[i] = capsule_around(std::array{corners(t), corners(t + 1), corners(t + 2), corners(t + 3)});
      EXPECT_LT(four[i].radius, 4.0F * 6.3e-5F) << "the rim of four";
      FourCapsules lanes_of;
      lanes_of.set(2, four[i]);
      const Vec3f middle = (corners(t + 1)[0] + corners(t + 1)[1]) * 0.5F;
      EXPECT_EQ(distances2_to_capsules(lanes_of, middle)[2], 0.0F);
      const float above = std::sqrt(distances2_to_capsules(lanes_of, middle + Vec3f(0.0F, 2.0F, 0.0F))[2]);
      EXPECT_GT(above, 1.9F);
      EXPECT_LT(above, 2.0F);
    }
    EXPECT_LT(capsule_around(four).radius, 16.0F * 6.3e-5F);
    const std::array<Capsule, 3> some{four[0], Capsule{}, four[1]};
    EXPECT_LT(capsule_around(some).radius, 8.0F * 6.3e-5F) << "what is not there counts for nothing";
  }
}

/// In doubles, of floats.
double distance_to_axis(const Capsule& capsule, const Vec3f& p) {
  const Vec3d along(capsule.along), away = Vec3d(p) - Vec3d(capsule.from);
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::min(std::max(glm::dot(away, along) / length2, 0.0), 1.0) : 0.0;
  return glm::length(away - along * t);
}

// Triangles of any shape, not only the needles of a hub: corners lie beyond both ends of the mean segment, too.
TEST(SurfaceTree, CapsulesHoldWhatTheyWereMadeAroundAndAreNoFartherThanIt) {
  Random random(7);
  const auto vector = [&](double size) {
    return Vec3f(size * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()));
  };
  for (int round = 0; round < 300; ++round) {
    std::array<Capsule, 4> four;
    std::vector<Vec3f> corners;
    FourCapsules lanes_of;
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<std::array<Vec3f, 3>, 4> triangles;
      const Vec3f at = vector(0.5);
      for (auto& triangle : triangles) {
        for (Vec3f& corner : triangle) {
          corner = at + vector(round % 2 == 0 ? 0.4 : 0.01);
          corners.push_back(corner);
        }
      }
      four[i] = capsule_around(triangles);
      lanes_of.set(i, four[i]);
      for (std::size_t c = corners.size() - 12; c < corners.size(); ++c) {
        ASSERT_LE(distance_to_axis(four[i], corners[c]), double{four[i].radius}) << "seed 7, round " << round;
        ASSERT_EQ(distances2_to_capsules(lanes_of, corners[c])[static_cast<int>(i)], 0.0F) << "round " << round;
      }
    }
    const Capsule all = capsule_around(four);
    for (const Vec3f& corner : corners) ASSERT_LE(distance_to_axis(all, corner), double{all.radius}) << round;
    const Vec3f p = vector(1.0);
    const auto distances2 = distances2_to_capsules(lanes_of, p);
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Vec3d away = Vec3d(p) - Vec3d(corners[c]);
      ASSERT_LE(double{distances2[static_cast<int>(c / 12)]}, glm::dot(away, away)) << "seed 7, round " << round;
    }
  }
}

TEST(SurfaceTree, AHubIsOneThoughItsCornersAreNumberedApart) {
  for (const std::uint32_t count : {kHubTriangles, kHubTriangles - 1}) {
    judge::Surface fan = test::as_surface(test::make_fan(count));
    for (auto& t : fan.triangles) {
      t[0] = static_cast<std::uint32_t>(fan.positions.size());
      fan.positions.push_back(fan.positions[0]);
    }
    EXPECT_FALSE(has_hub(fan.triangles, fan.positions.size()));
    EXPECT_EQ(SourceTree(fan.positions, fan.triangles).impl().has_hub(), count == kHubTriangles);
  }
}

}  // namespace
}  // namespace meshlode::builder
