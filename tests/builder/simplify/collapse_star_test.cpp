// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_star.h"

#include <algorithm>
#include <set>
#include <span>
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

Edges edges_of(std::span<const CollapseStar::OuterEdge> edges) {
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
  EXPECT_EQ(star.a.count, 6U);
  EXPECT_EQ(star.b.count, 6U);
  EXPECT_EQ(edges_of(star.outer()), (Edges{{2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}, {7, 8}, {8, 9}, {9, 2}}));
  EXPECT_TRUE(star.sheets().empty());
  for (const auto& edge : star.outer()) {
    const std::uint32_t hub = drawn.mesh.vertex(edge.corner);
    EXPECT_TRUE(hub == 0 || hub == 1);
    EXPECT_EQ(drawn.mesh.others(edge.corner), (std::array<std::uint32_t, 2>{edge.x, edge.y}));
  }
}

TEST(CollapseStar, TheOuterEdgesOfAnOpenFanArePathFromBorderToBorder) {
  DrawnMesh drawn = open_fan();
  EXPECT_EQ(edges_of(drawn.star(0, 1).outer()), (Edges{{2, 3}, {3, 4}, {4, 5}, {5, 6}}));
}

TEST(CollapseStar, CommonNeighborsAreNeighborsOfBothEnds) {
  DrawnMesh drawn = closed_fan();
  const CollapseStar star = drawn.star(0, 1);
  EXPECT_EQ(star.common_neighbors, 2U);
  EXPECT_EQ(star.on_edge, 2U);
  EXPECT_EQ((std::set<std::uint32_t>{star.tips[0], star.tips[1]}), (std::set<std::uint32_t>{4, 8}));
  EXPECT_FALSE(star.has_tip_edges);
  EXPECT_TRUE(tetrahedron().star(0, 1).has_tip_edges);
  // The fan without (1, 4, 0) has 4 beside both ends, and no triangle there.
  DrawnMesh window(test::kFanPoints, {{1, 3, 4}, {0, 4, 5}, {0, 8, 1}, {1, 8, 9}, {0, 7, 8}});
  EXPECT_EQ(window.star(0, 1).common_neighbors, 2U);
  EXPECT_EQ(window.star(0, 1).on_edge, 1U);
}

TEST(CollapseStar, AHubAndAnEdgeOfTooManyTrianglesAreTold) {
  std::vector<Vec3i> points{{0, 0, 0}, {1, 0, 0}};
  std::vector<WedgeTriangle> pages, wheel;
  for (std::uint32_t i = 0; i < Ring::kMost + 2; ++i) {
    points.push_back({static_cast<int>(i), 5, static_cast<int>(i * i)});
    if (i <= CollapseStar::kMostOnEdge) pages.push_back({0, 1, i + 2});
    if (i > 0) wheel.push_back({0, i + 1, i + 2});
  }
  VertexMarks marks(points.size());
  CollapseStar star;
  const auto gathered = [&](const std::vector<WedgeTriangle>& triangles) {
    DrawnMesh drawn(points, triangles);
    drawn.mesh.gather(0, star.a);
    drawn.mesh.gather(1, star.b);
    return gather_star(drawn.mesh, marks, star);
  };
  EXPECT_EQ(gathered(pages), Gathered::kTooMany);
  pages.pop_back();
  EXPECT_EQ(gathered(pages), Gathered::kStar);
  EXPECT_EQ(star.on_edge, CollapseStar::kMostOnEdge);
  EXPECT_EQ(gathered(wheel), Gathered::kNoTriangle);
  EXPECT_TRUE(star.a.is_hub);
  EXPECT_EQ(star.a.count, Ring::kMost);
  wheel.pop_back();
  EXPECT_EQ(gathered(wheel), Gathered::kNoTriangle);
  EXPECT_FALSE(star.a.is_hub);
  EXPECT_EQ(star.a.count, Ring::kMost);
}

/// The edges by their ends as triangles see them, against the numbers that they have.
void expect_numbered(const CollapseMesh& mesh) {
  for (std::uint32_t c = 0; c < 3 * mesh.triangle_count(); ++c) {
    if (!mesh.is_alive(c / 3)) continue;
    const std::uint32_t x = mesh.vertex(c), y = mesh.vertex(CollapseMesh::next_in_triangle(c));
    const CollapseMesh::Ends& ends = mesh.ends(mesh.edge(c));
    EXPECT_EQ(std::minmax(ends[0], ends[1]), std::minmax(x, y)) << c;
    for (std::uint32_t d = 0; d < c; ++d) {
      if (!mesh.is_alive(d / 3)) continue;
      const std::uint32_t u = mesh.vertex(d), v = mesh.vertex(CollapseMesh::next_in_triangle(d));
      EXPECT_EQ(mesh.edge(c) == mesh.edge(d), std::minmax(u, v) == std::minmax(x, y)) << c << " and " << d;
    }
  }
}

TEST(CollapseMesh, EdgesKeepTheirNumbersOnManifoldsAndOffThem) {
  for (const bool is_manifold : {true, false}) {
    DrawnMesh drawn = closed_fan();
    expect_numbered(drawn.mesh);
    const CollapseStar star = drawn.star(0, 1);
    drawn.mesh.join(star.a, star.b, star.gone(), star.on_edge, is_manifold);
    expect_numbered(drawn.mesh);
    EXPECT_EQ(drawn.mesh.alive_count(), 8U);
  }
  // Three triangles on the edge, and two edges to 5 that no triangle of it has.
  DrawnMesh book({{0, 0, 0}, {9, 0, 0}, {4, 5, 0}, {4, -5, 0}, {4, 0, 5}, {4, 0, 9}},
                 {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 5, 2}, {1, 5, 3}});
  book.join(0, 1);
  expect_numbered(book.mesh);
  EXPECT_EQ(book.mesh.alive_count(), 2U);
}

TEST(CollapseStar, TrianglesThatWentAreNotGathered) {
  DrawnMesh drawn = closed_fan();
  drawn.join(0, 1);
  const CollapseStar star = drawn.star(0, 4);
  EXPECT_EQ(star.a.count, 8U) << "ten without the two on the edge (0, 1)";
  // Of the merged star's eight triangles two lie on the edge (0, 4).
  EXPECT_EQ(edges_of(star.outer()), (Edges{{2, 3}, {5, 6}, {6, 7}, {7, 8}, {8, 9}, {9, 2}}));
}

TEST(CollapseStar, TrianglesThatComeToLieOnEachOtherAreASheet) {
  DrawnMesh drawn = tetrahedron();
  EXPECT_EQ(edges_of(drawn.star(0, 1).outer()), (Edges{{2, 3}, {3, 2}})) << "kept where sheets are not dropped";
  const CollapseStar star = drawn.star(0, 1, true);
  EXPECT_TRUE(star.outer().empty());
  ASSERT_EQ(star.sheets().size(), 2U) << "both";
  EXPECT_EQ(star.sheets()[0], 3U) << "the first around 0: triangle (2, 0, 3)";
  EXPECT_EQ(star.sheets()[1], 2U);
}

TEST(CollapseStar, OfThreeTrianglesOnEachOtherOneStays) {
  // Two triangles (0, 2, 3) and one the other way round; the fourth holds the edge (0, 1).
  DrawnMesh drawn({{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}}, {{0, 2, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 2}});
  const CollapseStar star = drawn.star(0, 1, true);
  EXPECT_EQ(edges_of(star.outer()), (Edges{{2, 3}}));
  EXPECT_EQ(star.sheets().size(), 2U);
}

}  // namespace
}  // namespace meshlode::builder
