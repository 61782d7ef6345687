// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/guards.h"

#include <utility>

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
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
  return builder::keeps_topology(is_border, drawn.star(a, b));
}

TEST(LinkCondition, HoldsInsideAFan) {
  DrawnMesh drawn = closed_fan();
  EXPECT_TRUE(keeps_topology(drawn, 0, 1, {2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(LinkCondition, FailsWithoutATriangleOnTheEdge) {
  DrawnMesh drawn = closed_fan();
  EXPECT_FALSE(keeps_topology(drawn, 0, 2)) << "7 vertices are beside 0 or 2, and no triangle has both";
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
  return turns_over(drawn.star_at(drawn.places.to_frame(target), 0, 1));
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
  EXPECT_FALSE(turns_over(drawn.star(0, 1)));
  const auto turns = [&](const Vec3i& target) {
    return turns_over(drawn.star_at(drawn.places.to_frame(target), 0, 1));
  };
  EXPECT_FALSE(turns({2, 3, 0})) << "inside of the fan";
  EXPECT_TRUE(turns({2, 5, 0})) << "beyond its border at (3, 4) and (4, 5)";
}

TEST(Flip, BothEndsCount) {
  DrawnMesh drawn({{0, 10, 0}, {0, 20, 0}, {0, 0, 0}, {10, 0, 0}}, {{2, 3, 1}});
  EXPECT_TRUE(turns_over(drawn.star_at(drawn.places.to_frame({0, -1, 0}), 0, 1)));
}

TEST(Flip, TheAngleIsTheSameForTrianglesOfOneStepInAWideGroup) {
  const auto turns_by = [&](const Vec3i& target) {
    const int far = 1 << 20;  // half the group's side: the cross products of its smallest triangle are 10^-12
    DrawnMesh drawn({{0, 10, 0}, {0, 20, 0}, {0, 0, 0}, {10, 0, 0}, {far, 0, 0}, {-far, 0, 0}}, {{2, 3, 0}});
    return turns_over(drawn.star_at(drawn.places.to_frame(target), 0, 1));
  };
  EXPECT_FALSE(turns_by({0, 3, 10})) << "73 degrees";
  EXPECT_TRUE(turns_by({0, 1, 10})) << "84 degrees";
}

const std::vector<Vec3i> kEarPoints{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {8, 8, 0}, {-8, 8, 0}};

/// 0 is locked, 1 comes to it, 2 is the tip.
bool keeps_shared_edges(const std::vector<WedgeTriangle>& triangles, bool is_tip_locked = true) {
  DrawnMesh drawn(kEarPoints, triangles);
  const GroupLocks locks({1, 0, is_tip_locked ? std::uint8_t{1} : std::uint8_t{0}, 0, 0}, Flags(5, 0),
                         drawn.wedge_position);
  return builder::keeps_shared_edges(drawn.mesh, locks, drawn.star(0, 1));
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
  EXPECT_TRUE(builder::keeps_shared_edges(drawn.mesh, locks, drawn.star(0, 1)));
}

/// How often a triangle of vertices runs from one to another, less how often back.
int runs(const WedgeTriangle& t, std::uint32_t from, std::uint32_t to) {
  int sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t a = t[k], b = t[(k + 1) % 3];
    sum += a == from && b == to ? 1 : a == to && b == from ? -1 : 0;
  }
  return sum;
}

/// The rule by all triangles, tip by tip: 0 is locked and 1 comes to it. What runs between 0 and a locked tip must run
/// as before where a triangle of 1 did; and where none did, what comes may not run against what is there.
bool plain_keeps_shared_edges(const std::vector<WedgeTriangle>& triangles, const Flags& is_locked) {
  const auto has = [](const WedgeTriangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; };
  for (std::uint32_t tip = 2; tip < is_locked.size(); ++tip) {
    if (is_locked[tip] == 0) continue;
    int going = 0, coming = 0, staying = 0;
    bool is_covered = false;
    for (const WedgeTriangle& t : triangles) {
      const int on_edge = has(t, tip) ? runs(t, tip, 0) : 0;
      staying += on_edge;
      if (!has(t, 1) || !has(t, tip)) continue;
      is_covered |= on_edge != 0;
      going += on_edge;
      if (on_edge == 0) coming += runs(t, tip, 1);
    }
    if (is_covered ? going != coming : coming * staying < 0) return false;
  }
  return true;
}

// Of as many triangles as a star has, too: such that no locked vertex sees, and pages of one locked edge.
TEST(SharedEdges, FollowTheRuleAroundFewTrianglesAndAroundMany) {
  test::RandomSource random(47);
  int kept = 0, lost = 0;
  for (int round = 0; round < 900; ++round) {
    const std::uint32_t few = 8, fillers = round % 3 == 0 ? 0 : 16;
    std::vector<WedgeTriangle> triangles{{0, 1, 2}};
    for (std::uint32_t n = 1 + random.below(7); n > 0; --n) {
      const std::uint32_t x = 2 + random.below(few - 2), y = 2 + random.below(few - 2);
      if (x != y) triangles.push_back({random.below(2), x, y});
    }
    for (std::uint32_t f = few; f + 1 < few + fillers; ++f) {
      if (round % 3 == 1) {
        triangles.push_back({1, f, f + 1});
      } else {  // pages of the edge (1, 2), as many this way as that, or not
        triangles.push_back(random.chance(0.5) ? WedgeTriangle{1, 2, f} : WedgeTriangle{2, 1, f});
      }
    }
    if (round % 6 == 2) {
      int balance = 0;
      for (const WedgeTriangle& t : triangles) balance += runs(t, 2, 0) == 0 ? runs(t, 2, 1) : -runs(t, 2, 0);
      for (; balance != 0; balance += balance > 0 ? -1 : 1) {
        const std::uint32_t page = few + random.below(fillers);
        triangles.push_back(balance > 0 ? WedgeTriangle{1, 2, page} : WedgeTriangle{2, 1, page});
      }
    }
    std::vector<Vec3i> points;
    for (std::uint32_t v = 0; v < few + fillers; ++v) {
      points.push_back({static_cast<int>(v * 37 % 101), static_cast<int>(v * 53 % 97), static_cast<int>(v)});
    }
    Flags is_locked(points.size(), 0);
    is_locked[0] = 1;
    for (std::uint32_t v = 2; v < few; ++v) is_locked[v] = random.chance(0.5) ? 1 : 0;
    DrawnMesh drawn(points, triangles);
    const GroupLocks locks(is_locked, Flags(points.size(), 0), drawn.wedge_position);
    const bool expected = plain_keeps_shared_edges(triangles, is_locked);
    ++(expected ? kept : lost);
    ASSERT_EQ(builder::keeps_shared_edges(drawn.mesh, locks, drawn.star(0, 1)), expected) << "seed 47, round " << round;
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(lost, 100);
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
    WedgeClasses classes;
    const CollapseStar star = drawn.star(0, 1);
    classes.collect(drawn.mesh, locks, star.a, star.b);
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

TEST(SharedCorners, NoVertexFallsTogetherWithALockedOneBesideIt) {
  const auto falls = [&](const std::vector<Vec3i>& points, const Flags& is_locked, const Vec3i& target) {
    DrawnMesh drawn(points, {{0, 1, 2}, {1, 3, 2}});
    CollapseStar star = drawn.star(0, 1);
    star.target = drawn.places.to_frame(target);
    const GroupLocks locks(is_locked, Flags(points.size(), 0), drawn.wedge_position);
    return falls_together(locks, drawn.places, star);
  };
  EXPECT_TRUE(falls(kEarPoints, {0, 0, 1, 0, 0}, {0, 8, 0}));
  EXPECT_FALSE(falls(kEarPoints, {0, 0, 1, 0, 0}, {0, 7, 0})) << "beside it";
  EXPECT_FALSE(falls(kEarPoints, {0, 0, 1, 0, 0}, {8, 8, 0})) << "on one that is not locked";
  EXPECT_TRUE(falls(kEarPoints, {0, 0, 0, 1, 1}, {8, 8, 0})) << "which a triangle of one end alone has";
  EXPECT_FALSE(falls(kEarPoints, {0, 0, 0, 1, 1}, {-8, 8, 0})) << "on one that no triangle of the star has";
  std::vector<Vec3i> points = kEarPoints;
  points[3] = points[0];
  EXPECT_TRUE(falls(points, {1, 0, 1, 0, 0}, points[0])) << "a free one that came to where the locked end is before";
  EXPECT_FALSE(falls(kEarPoints, {1, 0, 1, 0, 0}, kEarPoints[0])) << "an end itself";
}

}  // namespace
}  // namespace meshlode::builder
