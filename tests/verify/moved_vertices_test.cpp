// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/moved_vertices.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace meshlode {
namespace {

/// On a grid of step 1: a and b share the cell of the origin, the tip is far away.
const Vec3d kA{0.1, 0.0, 0.0}, kB{0.45, 0.1, 0.0}, kTip{0.0, 9.0, 0.0}, kOther{5.0, 0.0, 0.0};
constexpr GridPoint kCell{0, 0, 0}, kNext{1, 0, 0}, kTipCell{0, 9, 0}, kOtherCell{5, 0, 0};

TEST(MovedVertices, EachGoesToItsNearestPointWhereNothingIsMissing) {
  const MovedVertices vertices(Vec3d(0.0), 1.0);
  EXPECT_EQ(vertices.point_of(kA), kCell);
  EXPECT_EQ(vertices.point_of(kB), kCell);
  EXPECT_EQ(vertices.point_of({-0.5, 0.5, 1.49}), (GridPoint{0, 1, 1}));
}

TEST(MovedVertices, AMissingTriangleTellsWhichVertexMoved) {
  MovedVertices vertices(Vec3d(0.0), 1.0);
  const std::vector<MissingTriangle> missing{{0, {kA, kB, kTip}}, {0, {kB, kOther, kTip}}};
  std::vector<TriangleKey> stored{{0, rotate_to_smallest({kCell, kNext, kTipCell})},
                                  {0, rotate_to_smallest({kNext, kOtherCell, kTipCell})}};
  std::sort(stored.begin(), stored.end());
  vertices.find(missing, stored);
  EXPECT_EQ(vertices.point_of(kA), kCell);
  EXPECT_EQ(vertices.point_of(kB), kNext);
  EXPECT_EQ(vertices.point_of(kTip), kTipCell);
}

TEST(MovedVertices, NoneMovesFartherThanHalfACellsDiagonal) {
  MovedVertices vertices(Vec3d(0.0), 1.0);
  const GridPoint far_cell{2, 0, 0};
  const GridPoint beyond{0, -1, 0};  // of b at (0.45, 0.1) this is 1.19 away
  for (const GridPoint& cell : {far_cell, beyond}) {
    const std::vector<MissingTriangle> missing{{0, {kA, kB, kTip}}};
    const std::vector<TriangleKey> stored{{0, rotate_to_smallest({kCell, cell, kTipCell})}};
    vertices.find(missing, stored);
    EXPECT_EQ(vertices.point_of(kB), kCell);
  }
}

TEST(MovedVertices, OnlyCornersThatWouldHaveMetMayMove) {
  // This corner's nearest point is nobody else's: it has no reason to be elsewhere, however near.
  MovedVertices vertices(Vec3d(0.0), 1.0);
  const Vec3d apart{0.55, 0.45, 0.0};
  const std::vector<MissingTriangle> missing{{0, {kA, apart, kTip}}};
  const std::vector<TriangleKey> stored{{0, rotate_to_smallest({kCell, GridPoint{1, 1, 0}, kTipCell})}};
  vertices.find(missing, stored);
  EXPECT_EQ(vertices.point_of(kA), kCell);
  EXPECT_EQ(vertices.point_of(apart), kNext);
}

TEST(MovedVertices, AnotherMaterialOrWindingIsAnotherTriangle) {
  MovedVertices vertices(Vec3d(0.0), 1.0);
  const std::vector<MissingTriangle> missing{{0, {kA, kB, kTip}}};
  std::vector<TriangleKey> stored{{1, rotate_to_smallest({kCell, kNext, kTipCell})},
                                  {0, rotate_to_smallest({kNext, kCell, kTipCell})}};
  std::sort(stored.begin(), stored.end());
  vertices.find(missing, stored);
  EXPECT_EQ(vertices.point_of(kB), kCell);
}

}  // namespace
}  // namespace meshlode
