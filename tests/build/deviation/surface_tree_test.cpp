// SPDX-License-Identifier: GPL-3.0-or-later
// The tree against brute force: what it finds is the nearest up to the rounding of floats, never nearer than the truth.
#include "build/deviation/surface_tree.h"

#include <gtest/gtest.h>

#include <limits>

#include "build/deviation/surfaces.h"

namespace meshlode::build {
namespace {

using test::Random;

double brute_force(const judge::Surface& surface, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : surface.triangles) {
    best = std::min(
        best, point_triangle_distance2(p, {surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]}));
  }
  return std::sqrt(best);
}

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
        const double truth = brute_force(surface, p);
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
  const judge::Surface sphere = test::as_surface(scene::make_sphere(16));
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

}  // namespace
}  // namespace meshlode::build
