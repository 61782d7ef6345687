// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/quantize_normal.h"

#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "run/decode/octahedral.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using Point = std::array<std::int32_t, 3>;
using Pair = std::array<std::int32_t, 2>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// The angle between a direction and the stored one, accurate for small angles too.
double angle(const Vec3d& direction, const Point& p) {
  const Vec3d q(p[0], p[1], p[2]);
  return std::atan2(glm::length(glm::cross(direction, q)), glm::dot(direction, q));
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
Vec3f spread_direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count;
  const double r = std::sqrt(1.0 - z * z);
  const double turn = 2.399963229728653 * i;
  return {static_cast<float>(r * std::cos(turn)), static_cast<float>(r * std::sin(turn)), static_cast<float>(z)};
}

// The plane of an octahedron's face lies M / sqrt(3) from the centre and carries a lattice of triangles with side
// sqrt(2), whose points leave no place farther than sqrt(2) / sqrt(3) away. The angle is below the quotient.
TEST(Octahedral, ErrorIsBelowTheClosedForm) {
  for (const std::int32_t scale : {1, 2, 7, 100, 811, 1023, 8191}) {
    const double bound = std::sqrt(2.0) / scale;
    constexpr int kCount = 200000;
    double worst = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const Vec3f n = spread_direction(i, kCount);
      worst = std::max(worst, angle(Vec3d(n), nearest_octahedral_point(n, scale)));
    }
    EXPECT_LE(worst, bound) << scale;
    if (scale > 2) {
      EXPECT_GE(worst, 0.8 * bound) << scale << ": the bound is nearly reached in the middle of a face";
    }
  }
}

TEST(Octahedral, TheScaleOfABudgetKeepsIt) {
  EXPECT_EQ(octahedral_scale_for(0.1), 811U);
  for (const double degrees : {0.01, 0.1, 0.37, 1.0, 10.0, 179.0}) {
    const auto scale = static_cast<double>(octahedral_scale_for(degrees));
    EXPECT_LE(std::sqrt(2.0) / scale * 180.0 / 3.14159265358979, degrees);
  }
}

// Against every representable direction, not only those nearby.
TEST(Octahedral, NoOtherPointWouldBeNearer) {
  test::Random random(7);
  for (const std::int32_t scale : {1, 7, 15, 31}) {
    for (int i = 0; i < 3000; ++i) {
      Vec3f n(static_cast<float>(random.signed_unit()), static_cast<float>(random.signed_unit()),
              static_cast<float>(random.signed_unit()));
      if (i % 3 == 0) n[i / 3 % 3] *= 1e-3F;  // near the folds
      if (i % 7 == 0) n[(i / 7 + 1) % 3] *= 1e-3F;
      double best = 4.0;
      for (std::int32_t a = 0; a <= 2 * scale; ++a) {
        for (std::int32_t b = 0; b <= 2 * scale; ++b) {
          best = std::min(best, angle(Vec3d(n), run::octahedral_point(a, b, 4, scale)));
        }
      }
      ASSERT_LE(angle(Vec3d(n), nearest_octahedral_point(n, scale)), best + 1e-12) << "seed 7, direction " << i;
    }
  }
}

// I3: whatever the chart, a point comes back, and each has one pair of values in each.
TEST(Octahedral, EveryChartHoldsEveryPointOnce) {
  for (const std::int32_t scale : {1, 2, 7, 30}) {
    for (std::uint32_t chart = 0; chart < 6; ++chart) {
      std::map<Point, Pair> canonical;
      for (std::int32_t a = 0; a <= 2 * scale; ++a) {
        for (std::int32_t b = 0; b <= 2 * scale; ++b) {
          const Point p = run::octahedral_point(a, b, chart, scale);
          ASSERT_EQ(std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]), scale);
          const Pair pair = chart_coordinates(p, chart, scale);
          ASSERT_EQ(run::octahedral_point(pair[0], pair[1], chart, scale), p) << a << " " << b;
          ASSERT_EQ(canonical.emplace(p, pair).first->second, pair) << a << " " << b;
        }
      }
      // The integer points of an octahedron of radius M: 4 M² + 2.
      EXPECT_EQ(canonical.size(), static_cast<std::size_t>(4 * scale * scale + 2));
    }
  }
}

TEST(Octahedral, ThePoleOfAChartIsItsMiddle) {
  for (std::uint32_t chart = 0; chart < 6; ++chart) {
    Point pole{};
    pole[chart / 2] = chart % 2 == 0 ? 100 : -100;
    EXPECT_EQ(chart_coordinates(pole, chart, 100), (Pair{100, 100}));
  }
}

TEST(Octahedral, TheDecodedNormalEncodesToItself) {
  test::Random random(11);
  for (const std::int32_t scale : {127, 811, 8191}) {
    for (int i = 0; i < 20000; ++i) {
      const Point p =
          nearest_octahedral_point({static_cast<float>(random.signed_unit()), static_cast<float>(random.signed_unit()),
                                    static_cast<float>(random.signed_unit())},
                                   scale);
      EXPECT_EQ(nearest_octahedral_point(run::octahedral_normal(p), scale), p) << "seed 11";
    }
  }
}

TEST(Octahedral, AxesAreExactAndNegativeZeroIsZero) {
  for (const std::int32_t scale : {1, 811, 8191}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {1.0F, -1.0F}) {
        for (const float zero : {0.0F, -0.0F}) {
          Vec3f n(zero);
          n[axis] = sign;
          const Point p = nearest_octahedral_point(n, scale);
          EXPECT_EQ(run::octahedral_normal(p)[axis], sign);
          Point exact{};
          exact[static_cast<std::size_t>(axis)] = sign > 0.0F ? scale : -scale;
          EXPECT_EQ(p, exact);
        }
      }
    }
  }
}

TEST(Octahedral, NormalsOfPointsHaveLengthOne) {
  for (const Point& p : {Point{0, 0, 811}, Point{300, -500, 11}, Point{-1, 2, -808}}) {
    EXPECT_NEAR(glm::length(octahedral_normal(p)), 1.0, 1e-15);
  }
}

TEST(Octahedral, LengthDoesNotMatter) {
  for (const float scale : {1e-44F, 1e-30F, 1e-3F, 1e10F, 1e37F}) {
    EXPECT_EQ(nearest_octahedral_point({scale, -scale, scale}, 811), nearest_octahedral_point({1.0F, -1.0F, 1.0F}, 811))
        << scale;
  }
}

TEST(Octahedral, NormalsThatAreNoneBecomeUp) {
  for (const Vec3f& n : {Vec3f(0.0F), Vec3f(-0.0F), Vec3f(kNan), Vec3f(1.0F, kNan, 0.0F), Vec3f(kInf, 0.0F, 0.0F),
                         Vec3f(-kInf, kInf, kNan)}) {
    EXPECT_EQ(nearest_octahedral_point(n, 811), (Point{0, 0, 811}));
  }
}

}  // namespace
}  // namespace meshlode::builder
