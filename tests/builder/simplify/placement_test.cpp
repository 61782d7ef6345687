// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/placement.h"

#include <cmath>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

const Vec3d kA(0.0), kB(8.0, 0.0, 0.0);

/// Squared distance to the plane n·p = d, with n of unit length.
void add_plane(Quadric& q, const Vec3d& n, double d, double weight) {
  q.add_plane(n, -d, weight);
}

TEST(Placement, ACornerGetsItsVertexBack) {
  Quadric q;
  add_plane(q, {1, 0, 0}, 3.0, 1.0);
  add_plane(q, {0, 1, 0}, 5.0, 2.0);
  add_plane(q, {0, 0, 1}, -1.0, 1.0);
  const Vec3d place = place_vertex(q, kA, kB);
  EXPECT_NEAR(glm::distance(place, Vec3d(3, 5, -1)), 0.0, 1e-4) << "but for the pull";
}

TEST(Placement, OnAFlatSurfaceThePullSettlesIt) {
  Quadric q;
  add_plane(q, {0, 0, 1}, 0.0, 1.0);
  EXPECT_NEAR(glm::distance(place_vertex(q, kA, kB), (kA + kB) * 0.5), 0.0, 1e-9) << "the middle of the edge";
}

TEST(Placement, AlongACreaseThePullSettlesIt) {
  Quadric q;
  add_plane(q, {0, 0, 1}, 0.0, 1.0);
  add_plane(q, {0, 1, 0}, 5.0, 1.0);
  EXPECT_NEAR(glm::distance(place_vertex(q, kA, kB), Vec3d(4, 5, 0)), 0.0, 1e-4) << "on the crease, beside the middle";
}

TEST(Placement, TooFarOffTheBestPointOfTheEdgeIsTaken) {
  // Three planes meet at (6, 20, 0): more than 1.5 lengths of the edge from its middle.
  Quadric q;
  add_plane(q, {1, 0, 0}, 6.0, 1.0);
  add_plane(q, {0, 1, 0}, 20.0, 1.0);
  add_plane(q, {0, 0, 1}, 0.0, 1.0);
  const Vec3d place = place_vertex(q, kA, kB);
  EXPECT_NEAR(glm::distance(place, Vec3d(6, 0, 0)), 0.0, 1e-4);
  Quadric near;
  add_plane(near, {1, 0, 0}, 6.0, 1.0);
  add_plane(near, {0, 1, 0}, 11.0, 1.0);
  add_plane(near, {0, 0, 1}, 0.0, 1.0);
  EXPECT_NEAR(glm::distance(place_vertex(near, kA, kB), Vec3d(6, 11, 0)), 0.0, 1e-4) << "just within";
}

TEST(Placement, ADegenerateSystemFallsBackToTheEdge) {
  // A single plane and no weight, so that nothing pulls: the system has rank one.
  Quadric q;
  add_plane(q, glm::normalize(Vec3d(1, 1, 0)), 3.0 / std::sqrt(2.0), 1.0);
  q.weight = 0.0;
  EXPECT_NEAR(glm::distance(place_vertex(q, kA, kB), Vec3d(3, 0, 0)), 0.0, 1e-12);
}

TEST(Placement, WithoutTheFallbackAnyFiniteMinimumIsTaken) {
  Quadric q;  // the three planes of above meet far off
  add_plane(q, {1, 0, 0}, 6.0, 1.0);
  add_plane(q, {0, 1, 0}, 20.0, 1.0);
  add_plane(q, {0, 0, 1}, 0.0, 1.0);
  EXPECT_NEAR(glm::distance(place_vertex(q, kA, kB, false), Vec3d(6, 20, 0)), 0.0, 1e-9);
  Quadric flat;
  add_plane(flat, {0, 0, 1}, 0.0, 1.0);
  EXPECT_EQ(place_vertex(flat, kA, kB, false), (kA + kB) * 0.5) << "nothing to solve";
}

TEST(Placement, InFloatsItIsTheSameToTheirDigits) {
  BasicQuadric<float> q;
  q.add_plane({1, 0, 0}, -3.0F, 1.0F);
  q.add_plane({0, 1, 0}, -5.0F, 2.0F);
  q.add_plane({0, 0, 1}, 1.0F, 1.0F);
  EXPECT_NEAR(glm::distance(place_vertex(q, kA, kB), Vec3d(3, 5, -1)), 0.0, 1e-4);
}

TEST(Placement, BeyondTheEdgeItsEndIsTaken) {
  Quadric right, left;
  add_plane(right, {1, 0, 0}, 20.0, 1.0);
  add_plane(left, {1, 0, 0}, -2.0, 1.0);
  right.weight = left.weight = 0.0;
  EXPECT_EQ(place_vertex(right, kA, kB), kB);
  EXPECT_EQ(place_vertex(left, kA, kB), kA);
}

TEST(Placement, WhereNothingBendsTheCheaperEndIsTaken) {
  Quadric slope;  // 100 + 2 x: rounding can leave such a thing where all planes hold the edge
  slope.a02_b0[1] = 1.0;
  slope.b2_c[1] = 100.0;
  EXPECT_EQ(place_vertex(slope, kA, kB), kA);
  EXPECT_EQ(place_vertex(slope, kB, kA), kA) << "whichever end it is";
  Quadric none;
  EXPECT_EQ(place_vertex(none, kA, kB), (kA + kB) * 0.5) << "and the middle where all is one";
}

TEST(Placement, TheCostIsTheErrorOverTheRootOfTheArea) {
  Quadric q;
  add_plane(q, {0, 0, 1}, 0.0, 4.0);
  // 4 · 3² of the plane, 5 of fixed values, 1e-6 · 4 · 64 of the edge's length; over √4.
  EXPECT_NEAR(cost_of_collapse(q, {1, 2, 3}, 5.0, 64.0), (36.0 + 5.0 + 256e-6) / 2.0, 1e-12);
  q.weight = 0.0;
  EXPECT_NEAR(cost_of_collapse(q, {1, 2, 3}, 5.0, 64.0), 41.0, 1e-12) << "without area as it is";
}

}  // namespace
}  // namespace meshlode::builder
