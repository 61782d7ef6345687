// SPDX-License-Identifier: GPL-3.0-or-later
// What doubles lose where a distance is bounded from above, against exact arithmetic: on needles above all, whose
// insides doubles know least about.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "builder/deviation/deviation.h"
#include "builder/deviation/exact_distance.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surfaces.h"

namespace meshlode::builder {
namespace {

using test::is_within_exactly;
using test::Random;

constexpr double kUnit = 0x1p-53;

Vec3d random_vector(Random& random) {
  return {random.signed_unit(), random.signed_unit(), random.signed_unit()};
}

/// Corners at random, then two of them pulled together until the sine between their edges is about the one given.
TriangleCorners random_needle(Random& random, double sine, double offset) {
  const Vec3d far = offset * random_vector(random);
  TriangleCorners out{random_vector(random), random_vector(random), random_vector(random)};
  const std::size_t k = random.below(3);
  const double along = random.below(3) == 0 ? 0.5 * (random.signed_unit() + 1.0) : 1.0;
  out[k] = out[(k + 1) % 3] * along + out[(k + 2) % 3] * (1.0 - along) + sine * random_vector(random);
  for (Vec3d& corner : out) corner += far;
  return out;
}

double longest_edge(const TriangleCorners& t) {
  return std::max(glm::length(t[1] - t[0]), std::max(glm::length(t[2] - t[1]), glm::length(t[0] - t[2])));
}

TEST(Rounding, ADistanceToATriangleIsTooSmallByNoMoreThanItSays) {
  Random random(61);
  int beyond_double = 0;
  for (int round = 0; round < 4000; ++round) {
    const double sine = std::ldexp(1.0, -static_cast<int>(random.below(24)));
    const double offset = round % 3 == 0 ? 1000.0 : 0.0;
    const TriangleCorners t = random_needle(random, sine, offset);
    // A point of the triangle's plane or near it, inside or just beyond a corner or an edge.
    const std::size_t k = random.below(3);
    const double reach = std::ldexp(random.signed_unit(), -static_cast<int>(random.below(40)));
    const double side = std::ldexp(random.signed_unit(), -static_cast<int>(random.below(40)));
    const Vec3d normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    Vec3d p = t[k] + (t[k] - t[(k + 1) % 3]) * reach + (t[k] - t[(k + 2) % 3]) * side;
    const double length = glm::length(normal);
    if (round % 2 == 0 && length > 0.0) p += normal / length * std::ldexp(1.0, -static_cast<int>(random.below(60)));
    const double found = std::sqrt(point_triangle_distance2(p, t));
    ASSERT_TRUE(test::is_within_exactly(p, t, found * (1.0 + 8.0 * kUnit) + 9.0 * kUnit * longest_edge(t)))
        << "round " << round << ", sine " << sine;
    beyond_double += test::is_within_exactly(p, t, found) ? 0 : 1;
  }
  EXPECT_GT(beyond_double, 200) << "without the allowance the test must fail, or it says nothing";
}

TEST(Rounding, NorBesideTheSharpCornersOfNeedles) {
  // The signs of areas that are almost nothing decide here what lies over the inside.
  Random random(62);
  for (int round = 0; round < 2000; ++round) {
    const double sine = 1e-5 * (1.0 + 3.0 * std::fabs(random.signed_unit()));
    const Vec3d a = random_vector(random), b = random_vector(random);
    const Vec3d across = glm::normalize(glm::cross(b - a, random_vector(random)));
    const Vec3d c = a * 0.5 + b * 0.5 + across * (sine * glm::length(b - a));
    const TriangleCorners t = round % 2 == 0 ? TriangleCorners{a, b, c} : TriangleCorners{c, b, a};
    const double beyond = std::ldexp(1.0, -16 - static_cast<int>(random.below(14)));
    const double aside = std::ldexp(random.signed_unit(), -33 - static_cast<int>(random.below(4)));
    const Vec3d p = b + (b - a) * beyond + across * aside;
    const double found = std::sqrt(point_triangle_distance2(p, t));
    ASSERT_TRUE(test::is_within_exactly(p, t, found * (1.0 + 8.0 * kUnit) + 9.0 * kUnit * longest_edge(t)))
        << "round " << round << ", found " << found << " of " << glm::distance(p, b);
  }
}

/// A strip of needles, each triangle with area, and the same with some corners moved by a little.
judge::Surface needle_strip(Random& random, std::uint32_t count, double width) {
  judge::Surface surface;
  for (std::uint32_t i = 0; i <= count; ++i) {
    surface.positions.push_back(Vec3d(width * i, 0.001 * random.signed_unit(), 0.0));
    surface.positions.push_back(Vec3d(width * (i + 0.5), 0.001 * random.signed_unit(), 1.0));
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    surface.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    surface.triangles.push_back({2 * i + 2, 2 * i + 3, 2 * i + 1});
  }
  return surface;
}

TEST(Rounding, ACertifiedBoundHoldsExactlyOnNeedles) {
  Random random(63);
  for (int round = 0; round < 12; ++round) {
    const double width = std::ldexp(1.0, -4 * (round % 6) - 2);
    const judge::Surface fine = needle_strip(random, 12, width), coarse = needle_strip(random, 5, width * 12 / 5);
    const std::vector<TriangleBound> none(fine.triangles.size());
    const CertifiedGroup certified = certify_group(test::as_group(fine), none, test::as_group(coarse));
    // Points of each side, on dyadic weights so that none is off its triangle by more than doubles tell apart.
    const auto expect_near = [&](const judge::Surface& from, const judge::Surface& to) {
      for (const auto& t : from.triangles) {
        for (const Vec3d& w : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1), Vec3d(0.5, 0.25, 0.25)}) {
          const Vec3d p = from.positions[t[0]] * w.x + from.positions[t[1]] * w.y + from.positions[t[2]] * w.z;
          const bool is_near = std::any_of(to.triangles.begin(), to.triangles.end(), [&](const auto& c) {
            return is_within_exactly(p, {to.positions[c[0]], to.positions[c[1]], to.positions[c[2]]},
                                     certified.deviation);
          });
          EXPECT_TRUE(is_near) << "width " << width;
        }
      }
    };
    expect_near(fine, coarse);
    expect_near(coarse, fine);
  }
}

}  // namespace
}  // namespace meshlode::builder
