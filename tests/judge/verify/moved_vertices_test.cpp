// SPDX-License-Identifier: GPL-3.0-or-later
// The judge's points on the grid: by the rule of docs/reference/format.md ("Grid points"), case by case, and against
// the builder's, which shares no line of code with it.
#include "judge/verify/moved_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "builder/prepare/separate_needles.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

using Corners = std::array<Vec3d, 3>;

/// On a grid of step 1: a and b share the cell of the origin, the tip is far away.
const Vec3d kA{0.1, 0.0, 0.0}, kB{0.45, 0.1, 0.0}, kTip{0.0, 9.0, 0.0};
constexpr GridPoint kCell{0, 0, 0}, kNext{1, 0, 0}, kTipCell{0, 9, 0};

MovedVertices moved(const std::vector<Corners>& triangles) {
  MovedVertices vertices(Vec3d(0.0), 1.0);
  vertices.find(triangles);
  return vertices;
}

TEST(MovedVertices, EachGoesToItsNearestPointWithoutNeedles) {
  const MovedVertices vertices(Vec3d(0.0), 1.0);
  EXPECT_EQ(vertices.point_of(kA), kCell);
  EXPECT_EQ(vertices.point_of(kB), kCell);
  EXPECT_EQ(vertices.point_of({-0.5, 0.5, 1.49}), (GridPoint{0, 1, 1}));
}

TEST(MovedVertices, OfTwoCornersThatMeetTheOneNearerToAFreePointMoves) {
  const MovedVertices vertices = moved({{kA, kB, kTip}});
  EXPECT_EQ(vertices.point_of(kA), kCell);
  EXPECT_EQ(vertices.point_of(kB), kNext);
  EXPECT_EQ(vertices.point_of(kTip), kTipCell);
}

TEST(MovedVertices, AShortTriangleIsNoNeedle) {
  EXPECT_TRUE(moved({{kA, kB, {0.0, 3.4, 0.0}}}).empty());
  EXPECT_FALSE(moved({{kA, kB, {0.0, 3.6, 0.0}}}).empty());
}

TEST(MovedVertices, APointThatAVertexIsNearestToIsNotFree) {
  const Vec3d beside{0.9, 0.0, 0.0};
  EXPECT_TRUE(moved({{kA, kB, kTip}, {beside, {5, 5, 5}, {5, 6, 9}}}).empty())
      << "up by 0.9 is too far, and a has only b's side";
  // A vertex that has moved does not hold the point it came from against anybody, but holds the one it went to.
  const Vec3d other{0.46, 0.1, 0.0};
  const MovedVertices vertices = moved({{kA, kB, kTip}, {kA, other, kTip}});
  EXPECT_EQ(vertices.point_of(kB), kNext);
  EXPECT_EQ(vertices.point_of(other), kCell) << "b comes first";
}

TEST(MovedVertices, NoneMovesFartherThanHalfACellsDiagonal) {
  test::Random random(41);
  int count = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto in_cell = [&] { return 0.5 * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()); };
    const Vec3d a = in_cell(), b = in_cell();
    const MovedVertices vertices = moved({{a, b, kTip}});
    for (const Vec3d& p : {a, b}) {
      const GridPoint q = vertices.point_of(p);
      EXPECT_LE(glm::distance(p, Vec3d(q[0], q[1], q[2])), std::sqrt(0.75) * (1 + 1e-12));
      count += q != kCell ? 1 : 0;
    }
  }
  EXPECT_GT(count, 500);
}

TEST(MovedVertices, TheBuilderPutsEveryVertexThere) {
  test::Random random(42);
  std::uint64_t needles = 0;
  for (int round = 0; round < 400; ++round) {
    const double step = std::ldexp(static_cast<double>(1 + random.below(9)), static_cast<int>(random.below(40)) - 20);
    const Vec3d origin = std::floor(100.0 * random.signed_unit()) * step * Vec3d(1.0, -2.0, 3.0);
    const std::uint64_t cells = 1 + random.below(3), tips = 1 + random.below(12);
    std::vector<Vec3d> positions;
    const std::size_t count = 3 + random.below(60);
    for (std::size_t i = 0; i < count; ++i) {
      Vec3d p;
      for (int k = 0; k < 3; ++k) {
        p[k] = static_cast<double>(random.below(cells)) + 0.5 * random.signed_unit();
        if (round % 2 == 0) p[k] = std::floor(p[k] * 8.0) / 8.0;  // ties everywhere
      }
      if (i < tips) p += Vec3d(0.0, 9.0 + static_cast<double>(i), 0.0);
      positions.push_back(origin + p * step);
    }
    for (std::size_t i = count / 4; i > 0; --i) positions.push_back(positions[random.below(count)]);
    std::vector<std::uint32_t> triangles;
    const std::size_t corner_count = 3 * (5 + random.below(80));
    for (std::size_t i = 0; i < corner_count; ++i) {
      triangles.push_back(static_cast<std::uint32_t>(random.below(positions.size())));
    }

    const format::PositionGrid grid{std::ilogb(step), 1};
    const double grid_step = grid.step();
    std::vector<Vec3d> relative;
    std::vector<Vec3i> points;
    for (const Vec3d& p : positions) {
      relative.push_back(p - origin);
      points.push_back(grid.quantize(relative.back()));
    }
    needles += builder::separate_needles(relative, triangles, grid, points);

    std::vector<Corners> corners;
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      corners.push_back({positions[triangles[i]], positions[triangles[i + 1]], positions[triangles[i + 2]]});
    }
    MovedVertices vertices(origin, grid_step);
    vertices.find(corners);
    for (const std::uint32_t v : triangles) {
      const GridPoint q = vertices.point_of(positions[v]);
      ASSERT_EQ(points[v], Vec3i(q[0], q[1], q[2])) << "round " << round;
    }
    std::reverse(corners.begin(), corners.end());
    MovedVertices again(origin, grid_step);
    again.find(corners);
    for (const Vec3d& p : positions) ASSERT_EQ(again.point_of(p), vertices.point_of(p)) << "round " << round;
  }
  EXPECT_GT(needles, 500U);
}

TEST(MovedVertices, ManyNeedlesInOneCellTakeNoLongerThanTheirNumber) {
  // A quadratic search would take minutes here; the test's time limit is the check.
  test::Random random(43);
  std::vector<Corners> triangles;
  const auto in_cell = [&] { return 0.5 * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()); };
  Vec3d before = in_cell();
  for (int i = 0; i < 200000; ++i) {
    const Vec3d next = in_cell();
    triangles.push_back({before, next, kTip});
    before = next;
  }
  const MovedVertices vertices = moved(triangles);
  EXPECT_FALSE(vertices.empty());
}

}  // namespace
}  // namespace meshlode::judge
