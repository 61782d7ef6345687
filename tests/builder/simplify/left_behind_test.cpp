// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/left_behind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/point_triangle.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::closed_fan;
using test::DrawnMesh;
using test::in_frame;
using test::kFloats;
using test::open_fan;
using test::random_point;

/// Each vertex its own witness.
std::vector<Witnesses> own_witnesses(const DrawnMesh& drawn) {
  std::vector<Witnesses> out;
  for (const Vec3i& p : drawn.points) out.push_back({{p}, 1});
  return out;
}

/// Without any trust in how the triangles hang together.
double weigh_left(LeftBehind& left, DrawnMesh& drawn, const CollapseStar& star, bool keep_area = false) {
  const std::optional<float> left2 = left.weigh(drawn.mesh, drawn.places, drawn.marks, star, {false, false, keep_area});
  EXPECT_TRUE(left2.has_value());
  return double{left2.value_or(-1.0F)};
}

TEST(LeftBehind, AFlatFanLeavesNothing) {
  DrawnMesh drawn = closed_fan();
  LeftBehind left(own_witnesses(drawn), drawn.points);
  EXPECT_NEAR(weigh_left(left, drawn, drawn.star(0, 1)), 0.0, 1e-15);
}

TEST(LeftBehind, AWitnessIsLeftAtItsHeightAndGoesWithTheVertex) {
  DrawnMesh drawn = closed_fan();
  std::vector<Witnesses> witnesses = own_witnesses(drawn);
  const Vec3i low{4, 1, 1}, high{0, 1, 3}, higher{1, 0, -5};
  witnesses[0] = {{Vec3i{0, 0, 0}, high}, 2};
  witnesses[1] = {{low, higher}, 2};
  LeftBehind left(witnesses, drawn.points);
  EXPECT_NEAR(weigh_left(left, drawn, drawn.star(0, 1)), in_frame(drawn, 25), 1e-6);
  left.join(0, 1);
  ASSERT_EQ(left.witnesses(0).count, 3U) << "the farthest of four";
  EXPECT_EQ(left.witnesses(0).points, (std::array<Vec3i, 3>{higher, high, low}));
  EXPECT_NEAR(left.size2(0, drawn.places), in_frame(drawn, 16), 1e-12) << "it stands for both vertices";
}

TEST(LeftBehind, OfAnEdgeThatNothingCoversTheMiddleIsWeighed) {
  // 2 hangs on the edge (0, 1) by the triangle that goes, and on (3, 4) by another: the bridge between is lost.
  DrawnMesh drawn({{0, 0, 0}, {4, 0, 0}, {2, 8, 0}, {0, 12, 0}, {4, 12, 0}, {2, -4, 0}},
                  {{0, 1, 2}, {2, 4, 3}, {1, 0, 5}, {1, 5, 4}});
  LeftBehind left(own_witnesses(drawn), drawn.points);
  EXPECT_NEAR(weigh_left(left, drawn, drawn.star(0, 1)), in_frame(drawn, 0.25 * 64), kFloats);
}

TEST(LeftBehind, ASheetThatIsDroppedIsLeftAtHalfItsHeight) {
  // Another leaf at 0 and 1, so that the star is not empty and its two other vertices keep a triangle.
  DrawnMesh leaf({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}, {4, -2, -2}},
                 {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 4, 2}, {0, 3, 4}});
  LeftBehind left(std::vector<Witnesses>(5), leaf.points);
  const CollapseStar star = leaf.star(0, 1, true);
  ASSERT_EQ(star.sheets().size(), 2U);
  // From the middle (4, 0, 0) of the edge to the line through (0, 8, 0) and (0, 0, 8): 16 + 32.
  EXPECT_NEAR(weigh_left(left, leaf, star), in_frame(leaf, 0.25 * 48), kFloats);
}

TEST(LeftBehind, APieceThatVanishesIsAsFarOffAsWhatStays) {
  DrawnMesh drawn({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {-90, -90, 40}, {90, -90, 40}, {0, 90, 40}},
                  {{0, 1, 2}, {3, 4, 5}});
  LeftBehind left(own_witnesses(drawn), drawn.points);
  const CollapseStar star = drawn.star(0, 1);
  ASSERT_TRUE(star.outer().empty());
  EXPECT_NEAR(weigh_left(left, drawn, star), in_frame(drawn, 1600), kFloats);
  // Of foliage: its own size counts, here that of what goes with the tip: 1 + 4 from the middle of the edge.
  EXPECT_NEAR(weigh_left(left, drawn, star, true), in_frame(drawn, 5), kFloats);
}

TEST(LeftBehind, TheLastPieceIsBeyondAnyPrice) {
  DrawnMesh drawn({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  LeftBehind left(own_witnesses(drawn), drawn.points);
  EXPECT_EQ(weigh_left(left, drawn, drawn.star(0, 1)), double{1e30F});
}

TEST(LeftBehind, ANeighborThatVanishesIsWeighedByItsOwnWitnesses) {
  // The ear 6 of the open fan has no other triangle than (0, 5, 6); a star without it leaves it behind.
  DrawnMesh drawn = open_fan();
  std::vector<Witnesses> witnesses = own_witnesses(drawn);
  witnesses[6] = {{Vec3i{-4, 0, 9}}, 1};
  LeftBehind left(witnesses, drawn.points);
  // Collapse (0, 5): the triangle (0, 5, 6) goes, and 6 with it. Its witness is 9 above the plane and beside the star.
  const CollapseStar star = drawn.star(0, 5);
  EXPECT_GE(weigh_left(left, drawn, star), in_frame(drawn, 81));
  left.join(0, 5);
  EXPECT_EQ(left.witnesses(0).points[0], Vec3i(-4, 0, 9)) << "carried on by the vertex that stays";
}

TEST(LeftBehind, WhatGoesIsFoundByTheTipsOfAManifoldToo) {
  const std::vector<std::array<std::uint32_t, 3>> ears{
      {0, 5, 1}, {0, 1, 1}, {6, 5, 1}};  // ends, and whether on the border
  for (const auto& [a, b, is_on_border] : ears) {
    DrawnMesh drawn = open_fan();
    std::vector<Witnesses> witnesses = own_witnesses(drawn);
    witnesses[6] = {{Vec3i{-4, 0, 9}}, 1};
    LeftBehind left(witnesses, drawn.points);
    const CollapseStar star = drawn.star(a, b);
    const std::optional<float> by_tips =
        left.weigh(drawn.mesh, drawn.places, drawn.marks, star, {true, is_on_border != 0, false});
    ASSERT_TRUE(by_tips.has_value());
    EXPECT_EQ(double{*by_tips}, weigh_left(left, drawn, star)) << a << " and " << b;
  }
}

TEST(LeftBehind, MoreVerticesThanItHoldsAreRefused) {
  const auto is_weighed = [](std::uint32_t ears) {
    // On the edge (0, 1), which one triangle of each end keeps from being all that there is.
    std::vector<Vec3i> points{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0}};
    std::vector<WedgeTriangle> triangles{{0, 1, 2}, {1, 3, 2}};
    for (std::uint32_t e = 0; e < ears; ++e) {
      points.push_back({static_cast<int>(e), -6, 1});
      points.push_back({static_cast<int>(e), -6, 2});
      triangles.push_back({0, 4 + 2 * e, 5 + 2 * e});
      triangles.push_back({1, 5 + 2 * e, 4 + 2 * e});
    }
    DrawnMesh drawn(points, triangles);
    LeftBehind left(own_witnesses(drawn), drawn.points);
    const CollapseStar star = drawn.star(0, 1, true);
    return left.weigh(drawn.mesh, drawn.places, drawn.marks, star, {false, false, false}).has_value();
  };
  EXPECT_TRUE(is_weighed(4)) << "eight that go, with the ends ten";
  EXPECT_FALSE(is_weighed(5));
}

// Only products and sums are compared, none with a number of its own: a power of two changes no bit of the result.
TEST(PointTriangle, DistanceIsTheSameAtEveryScaleAndThatOfTheNearestOfAllPoints) {
  test::RandomSource random(51);
  for (int round = 0; round < 3000; ++round) {
    Vec3d p = random.in_cube(1.0);
    const Vec3d a = random.in_cube(1.0), b = random.in_cube(1.0);
    Vec3d c = random.in_cube(1.0);
    if (round % 4 == 0) p = a + (b - a) * random.unit() + (c - a) * random.unit();  // in the plane
    if (round % 8 == 1) c = a + (b - a) * random.between(-1.0, 2.0) + random.in_cube(1e-6);
    const double distance2 = distance2_to_facet(p, a, b, c);
    for (const double scale : {0x1p-40, 0x1p-12, 0x1p20}) {
      ASSERT_EQ(distance2_to_facet(p * scale, a * scale, b * scale, c * scale), distance2 * scale * scale)
          << "seed 51, round " << round;
    }
    if (round % 8 == 1) continue;  // of needles the steps below are too coarse
    // No point of a fine net is nearer; the nearest of it is within its mesh size.
    double nearest = std::numeric_limits<double>::infinity();
    constexpr int kSteps = 24;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3d q = a + (b - a) * (static_cast<double>(i) / kSteps) + (c - a) * (static_cast<double>(j) / kSteps);
        nearest = std::min(nearest, glm::length(p - q));
      }
    }
    const double longest = std::max({glm::length(b - a), glm::length(c - a), glm::length(c - b)});
    ASSERT_LE(std::sqrt(distance2), nearest + 1e-12) << "seed 51, round " << round;
    ASSERT_GE(std::sqrt(distance2), nearest - longest / kSteps) << "seed 51, round " << round;
  }
}

TEST(LeftBehind, WitnessesAreWeighedAgainstTheWholeStar) {
  test::RandomSource random(43);
  for (int round = 0; round < 300; ++round) {
    std::vector<Vec3i> points;
    for (const Vec3i& p : test::kFanPoints) points.push_back(p * 100 + random_point(random, round % 2 == 0 ? 2 : 90));
    DrawnMesh drawn(points, closed_fan().triangles);
    std::vector<Witnesses> witnesses(points.size());
    for (Witnesses& w : witnesses) {
      for (Vec3i& point : w.points) point = random_point(random, 900) - Vec3i(450);
      w.points[0] = points[random.below(10)];
      w.count = 3;
    }
    const CollapseStar star =
        round % 3 == 0 ? drawn.star_at(drawn.places.to_frame(points[random.below(10)]), 0, 1) : drawn.star(0, 1);
    std::vector<std::pair<double, Vec3i>> weighed;
    for (const std::uint32_t v : {0U, 1U}) {
      for (const Vec3i& witness : witnesses[v].points) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const CollapseStar::OuterEdge& edge : star.outer()) {
          nearest = std::min(nearest, distance2_to_facet(drawn.places.to_frame(witness), star.target,
                                                         drawn.places[edge.x], drawn.places[edge.y]));
        }
        weighed.emplace_back(nearest, witness);
      }
    }
    std::stable_sort(weighed.begin(), weighed.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    LeftBehind left(witnesses, drawn.points);
    EXPECT_NEAR(weigh_left(left, drawn, star), weighed[0].first, kFloats) << "seed 43, round " << round;
    left.join(0, 1);
    const auto distance2_of = [&](const Vec3i& point) {
      const auto found = std::find_if(weighed.begin(), weighed.end(), [&](const auto& w) { return w.second == point; });
      return found == weighed.end() ? std::numeric_limits<double>::infinity() : found->first;
    };
    for (std::size_t i = 0; i < Witnesses::kCapacity; ++i) {  // equals, but for what floats do not tell
      EXPECT_NEAR(distance2_of(left.witnesses(0).points[i]), weighed[i].first, kFloats) << "seed 43, round " << round;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
