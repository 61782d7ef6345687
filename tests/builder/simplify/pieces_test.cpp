// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/pieces.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::DrawnMesh;

// Three leaves of one size; the first two share a vertex.
const std::vector<Vec3i> kLeaves{{0, 0, 0},   {60, 0, 0},  {0, 60, 0},  {120, 0, 0},
                                 {60, 60, 0}, {300, 0, 0}, {360, 0, 0}, {300, 60, 0}};

DrawnMesh three_leaves() {
  return {kLeaves, {{0, 1, 2}, {1, 3, 4}, {5, 6, 7}}};
}

TEST(Pieces, HangTogetherByVertices) {
  const DrawnMesh drawn = three_leaves();
  const std::vector<std::uint32_t> piece_of = pieces_of(drawn.mesh, drawn.points.size());
  for (const std::uint32_t v : {1U, 2U, 3U, 4U}) EXPECT_EQ(piece_of[v], piece_of[0]);
  for (const std::uint32_t v : {6U, 7U}) EXPECT_EQ(piece_of[v], piece_of[5]);
  EXPECT_NE(piece_of[0], piece_of[5]);
  EXPECT_EQ(count_pieces(drawn.mesh, drawn.points.size()), 2U);
}

TEST(Pieces, AVertexWithoutATriangleCountsForNone) {
  DrawnMesh drawn = three_leaves();
  drawn.join(5, 6);  // its triangle goes
  EXPECT_EQ(count_pieces(drawn.mesh, drawn.points.size()), 1U);
}

/// The input covers three leaves; the first has gone and `locked` are locked.
struct Foliage {
  DrawnMesh drawn = three_leaves();
  SimplifyInput input = as_input(drawn);
  GroupPlaces before = drawn.places;

  explicit Foliage(const std::vector<std::uint32_t>& locked) {
    for (const std::uint32_t v : locked) input.is_locked[v] = 1;
    drawn.join(0, 2);
  }
};

TEST(Pieces, GrowUntilTheyCoverWhatWasCovered) {
  Foliage foliage({});
  const double moved = grow_pieces(foliage.input, foliage.drawn.mesh, foliage.drawn.places);
  // Two leaves for three: sides by √1.5, about the centre (320, 20) of the last one. Rounding moves by half a unit.
  const double growth = std::sqrt(1.5);
  const Vec3i& corner = foliage.drawn.places.on_grid(6);
  EXPECT_NEAR(corner.x, 320.0 + 40.0 * growth, 0.5);
  EXPECT_NEAR(corner.y, 20.0 - 20.0 * growth, 0.5);
  // The corner (360, 0) is √(40² + 20²) from the centre, and none is farther.
  EXPECT_NEAR(moved * foliage.drawn.places.scale(), std::sqrt(2000.0) * (growth - 1.0), 1e-9);
}

TEST(Pieces, ALockedPieceStaysAndTheOthersGrowForIt) {
  Foliage foliage({3});
  const double moved = grow_pieces(foliage.input, foliage.drawn.mesh, foliage.drawn.places);
  EXPECT_EQ(foliage.drawn.places.on_grid(4), kLeaves[4]);
  EXPECT_NEAR(moved * foliage.drawn.places.scale(), std::sqrt(2000.0) * (std::sqrt(2.0) - 1.0), 1e-9);
  Foliage fixed({3, 5});
  EXPECT_EQ(grow_pieces(fixed.input, fixed.drawn.mesh, fixed.drawn.places), 0.0);
  for (std::uint32_t v = 0; v < kLeaves.size(); ++v) EXPECT_EQ(fixed.drawn.places.on_grid(v), kLeaves[v]);
}

TEST(Pieces, GrowToTwiceTheirSizeAtMost) {
  Foliage foliage({});
  for (int copy = 0; copy < 4; ++copy) {
    const std::vector<WedgeTriangle> all = foliage.input.triangles;
    foliage.input.triangles.insert(foliage.input.triangles.end(), all.begin(), all.end());
  }
  const double moved = grow_pieces(foliage.input, foliage.drawn.mesh, foliage.drawn.places);
  EXPECT_NEAR(moved * foliage.drawn.places.scale(), std::sqrt(2000.0), 1e-9);
}

}  // namespace
}  // namespace meshlode::builder
