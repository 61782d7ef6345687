// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/simplify/guards.h"

#include <utility>

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"

namespace meshlode::build {
namespace {

using test::closed_fan;
using test::DrawnMesh;
using test::kFanPoints;
using test::open_fan;
using test::tetrahedron;

using Flags = std::vector<std::uint8_t>;

bool keeps_topology(DrawnMesh& drawn, std::uint32_t a, std::uint32_t b, const std::vector<std::uint32_t>& border = {}) {
  Flags is_border(drawn.points.size(), 0);
  for (const std::uint32_t v : border) is_border[v] = 1;
  CollapseStar star = drawn.star(a, b);
  VertexMarks marks(drawn.points.size());
  return build::keeps_topology(drawn.mesh, is_border, marks, star);
}

TEST(LinkCondition, HoldsInsideAFan) {
  DrawnMesh drawn = closed_fan();
  EXPECT_TRUE(keeps_topology(drawn, 0, 1, {2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(LinkCondition, FailsWithoutATriangleOnTheEdge) {
  DrawnMesh drawn = closed_fan();
  EXPECT_FALSE(keeps_topology(drawn, 0, 2));
}

TEST(LinkCondition, BorderVerticesJoinAlongTheBorderOnly) {
  DrawnMesh drawn = open_fan();
  const std::vector<std::uint32_t> border{6, 0, 1, 2, 3, 4, 5};
  EXPECT_TRUE(keeps_topology(drawn, 0, 1, border)) << "along it";
  EXPECT_FALSE(keeps_topology(drawn, 0, 4, border)) << "across: the fan would hang together by a point";
  EXPECT_TRUE(keeps_topology(drawn, 0, 4, {6, 0, 1, 2})) << "if 4 were inside of a larger surface";
}

TEST(LinkCondition, FailsWhereACommonNeighborHasNoTriangle) {
  // The fan without (1, 4, 0): collapsing (0, 1) would close the window that it leaves.
  DrawnMesh drawn(kFanPoints, {{1, 3, 4}, {0, 4, 5}, {0, 8, 1}, {1, 8, 9}, {0, 7, 8}});
  EXPECT_FALSE(keeps_topology(drawn, 0, 1, {0, 1, 4}));
}

TEST(LinkCondition, ATetrahedronWouldFoldFlat) {
  DrawnMesh drawn = tetrahedron();
  EXPECT_FALSE(keeps_topology(drawn, 0, 1));
}

TEST(LinkCondition, TwoLeavesWithOneTipWouldBecomeAnEdge) {
  DrawnMesh drawn({{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{0, 1, 2}, {1, 0, 2}});
  EXPECT_FALSE(keeps_topology(drawn, 0, 1));
}

TEST(LinkCondition, AnEdgeOfThreeLeavesMayGoAndOneOfFourStays) {
  const std::vector<Vec3i> points{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 8}, {0, 0, -8}};
  DrawnMesh three(points, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  EXPECT_TRUE(keeps_topology(three, 0, 1));
  DrawnMesh four(points, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 5}});
  EXPECT_FALSE(keeps_topology(four, 0, 1));
}

// A triangle on the edge (2, 3), which stays, with its tip 0 at y = 10; the edge (0, 1) gives it away to `target`.
bool turns_to(const Vec3i& target, const Vec3i& tip = {0, 10, 0}) {
  DrawnMesh drawn({tip, {0, 20, 0}, {0, 0, 0}, {10, 0, 0}}, {{2, 3, 0}});
  CollapseStar star = drawn.star(0, 1);
  star.target = drawn.places.to_frame(target);
  return turns_over(drawn.mesh, drawn.places, star);
}

TEST(Flip, ATriangleMayTurnBySeventyEightDegrees) {
  EXPECT_FALSE(turns_to({0, 1, 0})) << "flat, however thin";
  EXPECT_FALSE(turns_to({0, 3, 10})) << "by 73 degrees";
  EXPECT_TRUE(turns_to({0, 1, 10})) << "by 84 degrees";
  EXPECT_TRUE(turns_to({0, -1, 0})) << "over its base";
  EXPECT_TRUE(turns_to({5, 0, 0})) << "into its base";
}

TEST(Flip, ATriangleWithoutAreaMayBecomeAny) {
  EXPECT_FALSE(turns_to({0, -1, 0}, {5, 0, 0}));
}

TEST(Flip, TheTrianglesOnTheEdgeGoAndDoNotCount) {
  DrawnMesh drawn = closed_fan();
  CollapseStar star = drawn.star(0, 1);
  EXPECT_FALSE(turns_over(drawn.mesh, drawn.places, star));
  star.target = drawn.places.to_frame({2, 3, 0});
  EXPECT_FALSE(turns_over(drawn.mesh, drawn.places, star)) << "inside of the fan";
  star.target = drawn.places.to_frame({2, 5, 0});
  EXPECT_TRUE(turns_over(drawn.mesh, drawn.places, star)) << "beyond its border at (3, 4) and (4, 5)";
}

TEST(Flip, BothEndsCount) {
  DrawnMesh drawn({{0, 10, 0}, {0, 20, 0}, {0, 0, 0}, {10, 0, 0}}, {{2, 3, 1}});
  CollapseStar star = drawn.star(0, 1);
  star.target = drawn.places.to_frame({0, -1, 0});
  EXPECT_TRUE(turns_over(drawn.mesh, drawn.places, star));
}

const std::vector<Vec3i> kEarPoints{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 8, 0}, {-8, 8, 0}};

/// 0 is locked, 1 comes to it, 2 is the tip.
bool keeps_shared_edges(const std::vector<WedgeTriangle>& triangles, bool is_tip_locked = true) {
  DrawnMesh drawn(kEarPoints, triangles);
  const GroupLocks locks({1, 0, is_tip_locked ? std::uint8_t{1} : std::uint8_t{0}, 0, 0}, Flags(5, 0),
                         drawn.wedge_position);
  const bool is_kept = build::keeps_shared_edges(drawn.mesh, locks, drawn.star(0, 1));
  EXPECT_EQ(build::keeps_shared_edges(drawn.mesh, locks, drawn.star(1, 0)), is_kept) << "either end may be locked";
  return is_kept;
}

TEST(SharedEdges, ATriangleThatGoesNeedsAnHeirOfItsSharedEdge) {
  EXPECT_TRUE(keeps_shared_edges({{0, 1, 2}, {1, 3, 2}})) << "(1, 3, 2) will run from 2 to 0";
  EXPECT_FALSE(keeps_shared_edges({{0, 1, 2}})) << "an ear: nobody runs there any more";
  EXPECT_TRUE(keeps_shared_edges({{0, 1, 2}}, false)) << "an ear that nobody leans on";
  EXPECT_FALSE(keeps_shared_edges({{0, 1, 2}, {3, 1, 2}})) << "an heir that runs the other way";
}

TEST(SharedEdges, AnOpenEdgeDoesNotCloseASharedBorder) {
  // (0, 2) is a border of (0, 2, 4); what comes to lie on it may not run against it.
  EXPECT_FALSE(keeps_shared_edges({{0, 2, 4}, {1, 3, 2}}));
  EXPECT_TRUE(keeps_shared_edges({{0, 2, 4}, {3, 1, 2}})) << "along it: the border stays one";
  EXPECT_TRUE(keeps_shared_edges({{0, 2, 4}, {1, 3, 2}}, false)) << "where 2 is this group's own";
}

TEST(SharedEdges, WithoutALockedEndAllIsKept) {
  DrawnMesh drawn(kEarPoints, {{0, 1, 2}});
  const GroupLocks locks({0, 0, 1, 0, 0}, Flags(5, 0), drawn.wedge_position);
  EXPECT_TRUE(build::keeps_shared_edges(drawn.mesh, locks, drawn.star(0, 1)));
}

/// The triangle (0, 1, 2) goes and (1, 3, 2), by its wedges, is the heir of (0, 2). 0 and 2 are locked, 1 comes to 0.
/// The wedges 5 and 6 are second ones of 1 and 2; `shared` are another group's too, `more` are triangles beside the
/// two.
struct Heir {
  DrawnMesh drawn;
  GroupLocks locks;

  Heir(const WedgeTriangle& heir, const std::vector<std::uint32_t>& shared, std::vector<WedgeTriangle> more = {})
      : drawn(kEarPoints, with(std::move(more), heir), {1, 2}),
        locks({1, 0, 1, 0, 0}, Flags(7, 0), drawn.wedge_position) {
    for (const std::uint32_t w : shared) locks.is_wedge_shared[w] = 1;
  }
  static std::vector<WedgeTriangle> with(std::vector<WedgeTriangle> more, const WedgeTriangle& heir) {
    more.insert(more.end(), {{0, 1, 2}, heir});
    return more;
  }
  [[nodiscard]] bool keeps_corners() {
    WedgeClasses classes(drawn.wedge_position.size(), drawn.points.size());  // no wedge known to be a vertex's only one
    const CollapseStar star = drawn.star(0, 1);
    classes.collect(drawn.mesh, locks, star);
    return keeps_shared_corners(drawn.mesh, locks, classes, star);
  }
};

TEST(SharedCorners, AnHeirBringsTheWedgesThatAnotherGroupShades) {
  EXPECT_TRUE(Heir({1, 3, 2}, {0, 2}).keeps_corners());
  EXPECT_FALSE(Heir({1, 3, 6}, {2}).keeps_corners()) << "a crease at the tip";
  EXPECT_TRUE(Heir({1, 3, 6}, {0}).keeps_corners()) << "that nobody else shades";
  EXPECT_FALSE(Heir({5, 3, 2}, {0}).keeps_corners()) << "a crease at the moved vertex";
}

TEST(SharedCorners, ACreaseThatEndsAtTheLockedVertexIsOneToo) {
  // Below the edge, (0, 4, 1) has the wedge 5 at 1: both wedges of 1 come to be that of 0.
  EXPECT_FALSE(Heir({5, 3, 2}, {0}, {{0, 4, 5}}).keeps_corners());
  EXPECT_TRUE(Heir({5, 3, 2}, {}, {{0, 4, 5}}).keeps_corners()) << "that nobody else shades";
}

TEST(SharedCorners, NoBorderEdgeGetsAttributesThatNothingHadThere) {
  Heir crease({5, 3, 2}, {});
  EXPECT_FALSE(crease.keeps_corners()) << "wedge 5 would stand on 0 beside the locked 2";
  crease.locks.is_vertex_locked[2] = 0;
  EXPECT_TRUE(crease.keeps_corners()) << "where the edge is inside of the group";
  Heir newcomer({1, 3, 2}, {});
  EXPECT_TRUE(newcomer.keeps_corners());
  newcomer.locks.is_wedge_locked[2] = 0;
  EXPECT_FALSE(newcomer.keeps_corners()) << "as if wedge 2 had come with a vertex that was joined into it";
}

}  // namespace
}  // namespace meshlode::build
