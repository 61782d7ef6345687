// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_star.h"

#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::closed_fan;
using test::DrawnMesh;
using test::open_fan;
using test::tetrahedron;

using Edges = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

Edges edges_of(const std::vector<CollapseStar::OuterEdge>& edges) {
  Edges out;
  for (const auto& edge : edges) out.emplace(edge.x, edge.y);
  return out;
}

TEST(GroupPlaces, TheLongestSideOfTheGroupIsTwoInItsFrame) {
  const GroupPlaces places({{100, 50, 7}, {140, 60, 7}});
  EXPECT_EQ(places.scale(), 20.0);
  EXPECT_EQ(places[0], Vec3d(-1.0, -0.25, 0.0));
  EXPECT_EQ(places[1], Vec3d(1.0, 0.25, 0.0));
  EXPECT_EQ(GroupPlaces({{9, 9, 9}}).scale(), 1.0) << "a point has no side";
}

TEST(GroupPlaces, AMovedVertexStandsOnTheNearestPointOfTheGrid) {
  GroupPlaces places({{1000000, 0, 0}, {1000100, 0, 0}});
  const Vec3d between = places.to_frame({1000030, 4, 0}) + Vec3d(0.4, -0.4, 0.0) / places.scale();
  places.move(1, between);
  EXPECT_EQ(places.on_grid(1), Vec3i(1000030, 4, 0));
  EXPECT_EQ(places[1], places.to_frame({1000030, 4, 0}));
  EXPECT_EQ(places.to_grid(places[0]), places.on_grid(0));
}

TEST(CollapseStar, TheOuterEdgesOfAClosedFanAreItsBorder) {
  DrawnMesh drawn = closed_fan();
  const CollapseStar star = drawn.star(0, 1);
  EXPECT_EQ(star.a.corners.size(), 6U);
  EXPECT_EQ(star.b.corners.size(), 6U);
  EXPECT_EQ(edges_of(star.outer), (Edges{{2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}, {7, 8}, {8, 9}, {9, 2}}));
  EXPECT_TRUE(star.sheets.empty());
  for (const auto& edge : star.outer) {
    const std::uint32_t hub = drawn.mesh.vertex(edge.corner);
    EXPECT_TRUE(hub == 0 || hub == 1);
    EXPECT_EQ(drawn.mesh.others(edge.corner), (std::array<std::uint32_t, 2>{edge.x, edge.y}));
  }
}

TEST(CollapseStar, TheOuterEdgesOfAnOpenFanArePathFromBorderToBorder) {
  DrawnMesh drawn = open_fan();
  EXPECT_EQ(edges_of(drawn.star(0, 1).outer), (Edges{{2, 3}, {3, 4}, {4, 5}, {5, 6}}));
}

TEST(CollapseStar, NeighborsAreNamedOnceAndAloneAreMarked) {
  DrawnMesh drawn = closed_fan();
  CollapseStar star = drawn.star(0, 1);
  VertexMarks marks(drawn.points.size());
  for (const auto& [end, expected] : {std::pair(&star.b, std::set<std::uint32_t>{0, 2, 3, 4, 8, 9}),
                                      std::pair(&star.a, std::set<std::uint32_t>{1, 4, 5, 6, 7, 8})}) {
    gather_neighbors(drawn.mesh, marks, *end);
    EXPECT_EQ(end->neighbors.size(), expected.size());
    EXPECT_EQ(std::set<std::uint32_t>(end->neighbors.begin(), end->neighbors.end()), expected);
    for (std::uint32_t v = 0; v < drawn.points.size(); ++v) EXPECT_EQ(marks.is_marked(v), expected.contains(v));
  }
}

TEST(CollapseStar, TrianglesThatWentAreNotGathered) {
  DrawnMesh drawn = closed_fan();
  drawn.mesh.merge_vertices(0, 1);
  const CollapseStar star = drawn.star(0, 4);
  EXPECT_EQ(star.a.corners.size(), 8U) << "ten without the two on the edge (0, 1)";
  // Of the merged star's eight triangles two lie on the edge (0, 4).
  EXPECT_EQ(edges_of(star.outer), (Edges{{2, 3}, {5, 6}, {6, 7}, {7, 8}, {8, 9}, {9, 2}}));
}

TEST(CollapseStar, TrianglesThatComeToLieOnEachOtherAreASheet) {
  DrawnMesh drawn = tetrahedron();
  EXPECT_EQ(edges_of(drawn.star(0, 1).outer), (Edges{{2, 3}, {3, 2}})) << "kept where sheets are not dropped";
  const CollapseStar star = drawn.star(0, 1, true);
  EXPECT_TRUE(star.outer.empty());
  ASSERT_EQ(star.sheets.size(), 1U) << "one for both";
  EXPECT_EQ(edges_of(star.sheets), (Edges{{3, 2}})) << "the first around 0: triangle (2, 0, 3)";
}

TEST(CollapseStar, OfThreeTrianglesOnEachOtherOneStays) {
  // Two triangles (0, 2, 3) and one the other way round; the fourth holds the edge (0, 1).
  DrawnMesh drawn({{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}}, {{0, 2, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 2}});
  const CollapseStar star = drawn.star(0, 1, true);
  EXPECT_EQ(edges_of(star.outer), (Edges{{2, 3}}));
  EXPECT_EQ(star.sheets.size(), 1U);
}

}  // namespace
}  // namespace meshlode::builder
