// SPDX-License-Identifier: GPL-3.0-or-later
// The distance to a triangle against that of its parts: the foot on its plane where that lies inside, else the nearest
// point of three segments, with eleven more bits.
#include "builder/simplify/point_triangle.h"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode::builder {
namespace {

using Long3 = glm::vec<3, long double>;

long double distance2_to_segment(const Long3& p, const Long3& a, const Long3& b) {
  const Long3 edge = b - a, ap = p - a;
  const long double length2 = glm::dot(edge, edge);
  const long double t = length2 > 0.0L ? std::clamp(glm::dot(ap, edge) / length2, 0.0L, 1.0L) : 0.0L;
  const Long3 away = ap - edge * t;
  return glm::dot(away, away);
}

long double distance2_to_triangle(const Long3& p, const Long3& a, const Long3& b, const Long3& c) {
  const Long3 n = glm::cross(b - a, c - a);
  const long double nn = glm::dot(n, n);
  const auto is_inside = [&](const Long3& from, const Long3& to) {
    return glm::dot(glm::cross(to - from, p - from), n) >= 0.0L;
  };
  if (nn > 0.0L && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) {
    const long double height = glm::dot(p - a, n);
    return height * height / nn;
  }
  return std::min({distance2_to_segment(p, a, b), distance2_to_segment(p, b, c), distance2_to_segment(p, c, a)});
}

/// Near every corner, every edge and the inside, on both sides of each border between their regions.
TEST(PointTriangle, IsTheNearestOfInsideAndEdges) {
  test::RandomSource random(111);
  for (int round = 0; round < 20000; ++round) {
    const std::array<Vec3d, 3> t{random.in_cube(1.0), random.in_cube(1.0), random.in_cube(1.0)};
    const Vec3d ab = t[1] - t[0], ac = t[2] - t[0], n = glm::cross(ab, ac);
    const double longest2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(t[2] - t[1], t[2] - t[1])});
    if (glm::dot(n, n) < 1e-4 * longest2 * longest2) continue;
    const double v = random.between(-1.0, 2.0), w = random.between(-1.0, 2.0);
    const double up = round % 3 == 0 ? 0.0 : random.between(-1.0, 1.0);
    const Vec3d p = t[0] + ab * v + ac * w + n * up;
    const long double expected = distance2_to_triangle(Long3(p), Long3(t[0]), Long3(t[1]), Long3(t[2]));
    const double size2 = longest2 + glm::dot(p - t[0], p - t[0]);
    ASSERT_NEAR(static_cast<double>(expected), distance2_to_facet(p, t[0], t[1], t[2]), 1e-13 * size2)
        << "seed 111, round " << round;
  }
}

// Beyond rounding a point of the triangle is no distance away from it: half as many digits are left of its square.
TEST(PointTriangle, APointOfTheTriangleIsOnIt) {
  test::RandomSource random(112);
  for (int round = 0; round < 20000; ++round) {
    const std::array<Vec3d, 3> t{random.in_cube(1.0), random.in_cube(1.0), random.in_cube(1.0)};
    const Vec3d ab = t[1] - t[0], ac = t[2] - t[0], n = glm::cross(ab, ac);
    if (glm::dot(n, n) < 1e-4) continue;
    double v = random.unit(), w = random.unit() * (1.0 - v);
    if (round % 4 == 1) v = 0.0;
    if (round % 4 == 2) w = 0.0;
    if (round % 4 == 3) w = 1.0 - v;
    const Vec3d p = t[0] + ab * v + ac * w;
    ASSERT_LE(distance2_to_facet(p, t[0], t[1], t[2]), 1e-26) << "seed 112, round " << round;
    // And from above its foot is found as well: the height is all that is left.
    const Vec3d up = n * (0.5 / glm::length(n));
    ASSERT_NEAR(distance2_to_facet(p + up, t[0], t[1], t[2]), 0.25, 1e-13) << "seed 112, round " << round;
  }
}

/// Of small whole numbers, so that points, segments and right angles come up; -1 where no distance was worked out.
TEST(PointTriangle, WithoutAreaItIsItsLongestEdge) {
  test::RandomSource random(113);
  const auto draw = [&](std::uint32_t size) {
    const double x = random.below(size), y = random.below(size), z = random.below(size);
    return Vec3d(x, y, z);
  };
  for (int round = 0; round < 20000; ++round) {
    const Vec3d a = draw(4), step = draw(3) - Vec3d(1.0), p = draw(6) - Vec3d(1.0);
    const Vec3d b = a + step * static_cast<double>(random.below(5)) - step * 2.0;
    const Vec3d c = a + step * static_cast<double>(random.below(5)) - step * 2.0;
    const long double expected = distance2_to_triangle(Long3(p), Long3(a), Long3(b), Long3(c));
    ASSERT_NEAR(static_cast<double>(expected), distance2_to_facet(p, a, b, c), 1e-13) << "seed 113, round " << round;
  }
}

/// On a lattice every border between two regions is met exactly, and all there agree.
TEST(PointTriangle, OnALatticeTooWhereRegionsMeet) {
  const std::array<std::array<Vec3d, 3>, 4> triangles{{{Vec3d(0, 0, 0), Vec3d(4, 0, 0), Vec3d(0, 4, 0)},
                                                       {Vec3d(0, 0, 0), Vec3d(4, 0, 0), Vec3d(2, 4, 0)},
                                                       {Vec3d(0, 0, 0), Vec3d(4, 0, 0), Vec3d(8, 2, 0)},
                                                       {Vec3d(0, 0, 0), Vec3d(4, 2, 2), Vec3d(-2, 4, 0)}}};
  for (const auto& [a, b, c] : triangles) {
    for (int x = -8; x <= 12; ++x) {
      for (int y = -8; y <= 12; ++y) {
        for (const int z : {0, 1}) {
          const Vec3d p(x, y, z);
          const double expected = static_cast<double>(distance2_to_triangle(Long3(p), Long3(a), Long3(b), Long3(c)));
          EXPECT_NEAR(distance2_to_facet(p, a, b, c), expected, 1e-13) << x << ", " << y << ", " << z;
          EXPECT_NEAR(distance2_to_facet(p, b, c, a), expected, 1e-13) << x << ", " << y << ", " << z;
          EXPECT_NEAR(distance2_to_facet(p, c, b, a), expected, 1e-13) << x << ", " << y << ", " << z;
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
