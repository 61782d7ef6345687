// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/wedge_classes.h"

#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::closed_fan;
using test::DrawnMesh;
using test::kFanPoints;
using test::kLowerFan;
using test::kUpperFan;
using test::seamed_fan;

using Members = std::set<std::vector<std::uint32_t>>;

/// Nothing locked.
GroupLocks no_locks(const DrawnMesh& drawn) {
  return {std::vector<std::uint8_t>(drawn.points.size(), 0), std::vector<std::uint8_t>(drawn.wedge_position.size(), 0),
          drawn.wedge_position};
}

WedgeClasses classes_of(DrawnMesh& drawn) {
  WedgeClasses classes(drawn.wedge_position.size(), drawn.points.size());
  StarEnd end;
  for (end.vertex = 0; end.vertex < drawn.points.size(); ++end.vertex) {
    drawn.mesh.corners_of(end.vertex, end.corners);
    classes.update(drawn.mesh, end);
  }
  return classes;
}

Members members_of(const WedgeClasses& classes) {
  Members out;
  for (const WedgeClass& c : classes.classes()) out.insert(c.members);
  return out;
}

Members collect(DrawnMesh& drawn, std::uint32_t a, std::uint32_t b) {
  WedgeClasses classes = classes_of(drawn);
  classes.collect(drawn.mesh, no_locks(drawn), drawn.star(a, b));
  return members_of(classes);
}

/// In one pass over the corners what a look around each vertex tells.
TEST(WedgeClasses, StartKnowsWhatUpdatesTell) {
  for (DrawnMesh drawn : {closed_fan(), seamed_fan()}) {
    const WedgeClasses told = classes_of(drawn);
    WedgeClasses started(drawn.wedge_position.size(), drawn.points.size());
    started.start(drawn.mesh);
    for (std::uint32_t a = 0; a < drawn.points.size(); ++a) {
      ASSERT_EQ(started.needs_corners(a, a), told.needs_corners(a, a)) << a;
      if (!told.needs_corners(a, a)) {
        EXPECT_EQ(started.pair_of(no_locks(drawn), a, a).least, told.pair_of(no_locks(drawn), a, a).least) << a;
      }
    }
  }
}

TEST(WedgeClasses, OfTwoVerticesWithoutASeamTheWedgesAreOne) {
  DrawnMesh drawn = closed_fan();
  EXPECT_FALSE(classes_of(drawn).needs_corners(1, 0));
  EXPECT_EQ(collect(drawn, 1, 0), (Members{{0, 1}}));
}

TEST(WedgeClasses, AlongASeamEachSideIsItsOwn) {
  DrawnMesh drawn = seamed_fan();
  EXPECT_TRUE(classes_of(drawn).needs_corners(0, 1));
  EXPECT_EQ(collect(drawn, 0, 1), (Members{{0, 1}, {10, 11}}));
}

TEST(WedgeClasses, OffASeamItsOtherSideStaysAsItIs) {
  DrawnMesh drawn = seamed_fan();
  EXPECT_TRUE(classes_of(drawn).needs_corners(4, 0)) << "one end on the seam is enough";
  EXPECT_TRUE(classes_of(drawn).needs_corners(0, 4)) << "either of them";
  EXPECT_EQ(collect(drawn, 4, 0), (Members{{0, 4}, {10}}));
  EXPECT_EQ(collect(drawn, 0, 8), (Members{{8, 10}, {0}}));
}

TEST(WedgeClasses, WhereASeamEndsItsSidesBecomeOne) {
  // The seam ends at 1: 10 is the lower wedge of 0, and 1 has one wedge.
  std::vector<WedgeTriangle> all = kUpperFan;
  for (WedgeTriangle t : kLowerFan) {
    for (std::uint32_t& w : t) w = w == 0 ? 10 : w;
    all.push_back(t);
  }
  DrawnMesh drawn(kFanPoints, all, {0});
  EXPECT_EQ(collect(drawn, 0, 1), (Members{{0, 1, 10}}));
}

TEST(WedgeClasses, OfAFacetedFanOnlyTheTrianglesOnTheEdgeJoinTheirs) {
  // Each triangle has wedges of its own: 10 + 3 t + k.
  std::vector<WedgeTriangle> all = kUpperFan, faceted;
  all.insert(all.end(), kLowerFan.begin(), kLowerFan.end());
  std::vector<std::uint32_t> more;
  for (const WedgeTriangle& t : all) {
    const auto first = static_cast<std::uint32_t>(kFanPoints.size() + more.size());
    faceted.push_back({first, first + 1, first + 2});
    more.insert(more.end(), t.begin(), t.end());
  }
  DrawnMesh drawn(kFanPoints, faceted, more);
  const Members members = collect(drawn, 0, 1);
  EXPECT_EQ(members.size(), 10U) << "six wedges at each end, two pairs joined";
  EXPECT_EQ(members.count({16, 18}), 1U) << "triangle 2 is (1, 4, 0)";
  EXPECT_EQ(members.count({31, 33}), 1U) << "triangle 7 is (0, 8, 1)";
}

TEST(WedgeClasses, TheFirstLockedWedgeRules) {
  DrawnMesh drawn = seamed_fan();
  GroupLocks locks = no_locks(drawn);
  locks.is_wedge_locked[11] = 1;
  WedgeClasses classes = classes_of(drawn);
  classes.collect(drawn.mesh, locks, drawn.star(0, 1));
  ASSERT_EQ(classes.classes().size(), 2U);
  for (const WedgeClass& c : classes.classes()) {
    const bool is_upper = c.members[0] == 0;
    EXPECT_EQ(c.fixed, is_upper ? kNoId : 11U);
    EXPECT_EQ(c.keeper(), is_upper ? 0U : 11U);
  }
  EXPECT_TRUE(classes.joins_locked(10));
  EXPECT_FALSE(classes.joins_locked(0));
  locks.is_wedge_locked[10] = 1;
  classes.collect(drawn.mesh, locks, drawn.star(0, 1));
  EXPECT_TRUE(classes.joins_locked(11));
  for (const WedgeClass& c : classes.classes()) EXPECT_TRUE(c.fixed == kNoId || c.fixed == 10U);
}

TEST(WedgeClasses, AfterTheCollapseTheCornersHaveTheKeepers) {
  DrawnMesh drawn = seamed_fan();
  WedgeClasses classes = classes_of(drawn);
  const CollapseStar star = drawn.star(0, 1);
  classes.collect(drawn.mesh, no_locks(drawn), star);
  for (const WedgeClass& c : classes.classes()) relabel_wedges(drawn.mesh, star, c);
  drawn.mesh.merge_vertices(0, 1);
  StarEnd joined;
  drawn.mesh.corners_of(0, joined.corners);
  std::multiset<std::uint32_t> wedges;
  for (const std::uint32_t corner : joined.corners) wedges.insert(drawn.mesh.wedge(corner));
  EXPECT_EQ(wedges, (std::multiset<std::uint32_t>{0, 0, 0, 0, 10, 10, 10, 10}));
  classes.update(drawn.mesh, joined);
  EXPECT_TRUE(classes.needs_corners(0, 3)) << "the seam still goes through it";
}

TEST(WedgeClasses, WithoutAttributesThereAreNone) {
  DrawnMesh drawn = closed_fan();
  WedgeClasses classes(0, drawn.points.size());
  EXPECT_FALSE(classes.needs_corners(0, 1));
  classes.collect(drawn.mesh, no_locks(drawn), drawn.star(0, 1));
  EXPECT_TRUE(classes.classes().empty());
}

}  // namespace
}  // namespace meshlode::builder
