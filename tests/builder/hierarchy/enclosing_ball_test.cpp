// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest enclosing ball against closed forms, and against the convexity of the problem: a centre that no small
// step improves is the best one.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builder/hierarchy/enclosing_ball.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::RandomSource;

double radius_at(const std::vector<Ball>& balls, const Vec3d& center) {
  double radius = 0.0;
  for (const Ball& b : balls) radius = std::max(radius, glm::length(b.center - center) + b.radius);
  return radius;
}

void expect_ball(const std::vector<Ball>& balls, const Vec3d& center, double radius) {
  const Ball ball = enclosing_ball(balls);
  EXPECT_NEAR(ball.center.x, center.x, 1e-12 * radius + 1e-15);
  EXPECT_NEAR(ball.center.y, center.y, 1e-12 * radius + 1e-15);
  EXPECT_NEAR(ball.center.z, center.z, 1e-12 * radius + 1e-15);
  EXPECT_NEAR(ball.radius, radius, 1e-12 * radius);
}

TEST(EnclosingBall, IsTheBallItselfForOneOrForCopiesOfOne) {
  expect_ball({{{1, 2, 3}, 4}}, {1, 2, 3}, 4);
  expect_ball(std::vector<Ball>(9, Ball{{1, 2, 3}, 4}), {1, 2, 3}, 4);
  expect_ball(std::vector<Ball>(9, Ball{{1, 2, 3}, 0}), {1, 2, 3}, 0);
}

TEST(EnclosingBall, SpansTwoBallsAndSwallowsABallInside) {
  expect_ball({{{0, 0, 0}, 1}, {{10, 0, 0}, 3}}, {6, 0, 0}, 7);
  expect_ball({{{0, 0, 0}, 5}, {{1, 0, 0}, 2}, {{0, 3, 0}, 2}}, {0, 0, 0}, 5);
}

TEST(EnclosingBall, IsTheCircumscribedBallOfRegularPointSets) {
  expect_ball({{{1, 1, 1}}, {{1, -1, -1}}, {{-1, 1, -1}}, {{-1, -1, 1}}}, {0, 0, 0}, std::sqrt(3.0));
  std::vector<Ball> cube;
  for (int i = 0; i < 8; ++i) cube.push_back({{i & 1, (i >> 1) & 1, (i >> 2) & 1}, 0.25});
  expect_ball(cube, {0.5, 0.5, 0.5}, std::sqrt(0.75) + 0.25);
  expect_ball({{{0, 0, 0}}, {{1, 0, 0}}, {{2, 0, 0}}, {{3, 0, 0}}}, {1.5, 0, 0}, 1.5);  // collinear
}

TEST(EnclosingBall, CannotBeImprovedByAnyStepAtAnySizeAndOffset) {
  RandomSource random(31);
  for (int i = 0; i < 3000; ++i) {
    const double size = std::vector<double>{1e-6, 1e-3, 1.0, 1e9}[random.below(4)];
    const Vec3d offset = random.chance(0.4) ? random.in_cube(size * 1e9) : Vec3d(0.0);
    std::vector<Ball> balls;
    const bool flat = random.chance(0.2), points = random.chance(0.3);
    for (std::uint32_t n = 2 + random.below(60); n > 0; --n) {
      Vec3d c = random.in_cube(size);
      if (flat) c.z *= 1e-9;
      balls.push_back({c + offset, points ? 0.0 : random.unit() * size});
      if (random.chance(0.2)) balls.push_back(balls.back());
    }
    const Ball ball = enclosing_ball(balls);
    const double radius = radius_at(balls, ball.center);
    const double rounding = 1e-15 * (glm::length(ball.center) + radius);
    ASSERT_NEAR(ball.radius, radius, 1e-9 * radius + 4.0 * rounding);
    // Convex: if a step of 1% gains nothing beyond rounding, the best radius is within a small factor of that rounding.
    for (int n = 0; n < 30; ++n) {
      ASSERT_GE(radius_at(balls, ball.center + random.direction() * (0.01 * radius)),
                radius * (1.0 - 1e-9) - 4.0 * rounding)
          << "seed 31, set " << i;
    }
  }
}

TEST(EnclosingBall, DoesNotDependOnTheScaleWhichIsAPowerOfTwo) {
  RandomSource random(32);
  for (int i = 0; i < 300; ++i) {
    std::vector<Ball> balls, scaled;
    const double s = std::ldexp(1.0, static_cast<int>(random.below(301)) - 150);
    for (int n = 0; n < 20; ++n) {
      balls.push_back({random.in_cube(1.0), random.unit()});
      scaled.push_back({balls.back().center * s, balls.back().radius * s});
    }
    const Ball a = enclosing_ball(balls), b = enclosing_ball(scaled);
    EXPECT_EQ(a.center * s, b.center);
    EXPECT_EQ(a.radius * s, b.radius);
  }
}

}  // namespace
}  // namespace meshlode::builder
