// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/wedge_classes.h"

#include <algorithm>
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

Members members_of(const WedgeClasses& classes) {
  Members out;
  for (std::uint32_t first = 0; first < classes.count(); ++first) {
    if (!classes.is_first(first)) continue;
    std::vector<std::uint32_t> members;
    for (std::uint32_t i = 0; i < classes.count(); ++i) {
      if (classes.class_of(i) == first) members.push_back(classes.wedge(i));
    }
    std::sort(members.begin(), members.end());
    out.insert(members);
  }
  return out;
}

WedgeClasses classes_of(DrawnMesh& drawn, const GroupLocks& locks, std::uint32_t a, std::uint32_t b) {
  WedgeClasses classes;
  const CollapseStar star = drawn.star(a, b);
  classes.collect(drawn.mesh, locks, star.a, star.b);
  return classes;
}
Members collect(DrawnMesh& drawn, std::uint32_t a, std::uint32_t b) {
  return members_of(classes_of(drawn, no_locks(drawn), a, b));
}

TEST(OnlyWedges, AreToldOfVerticesWithoutASeam) {
  const DrawnMesh closed = closed_fan(), seamed = seamed_fan();
  const OnlyWedges one(closed.mesh), several(seamed.mesh);
  EXPECT_FALSE(one.has_seams());
  EXPECT_TRUE(several.has_seams());
  const std::set<std::uint32_t> on_seam{0, 1, 2, 6};
  for (std::uint32_t v = 0; v < closed.points.size(); ++v) {
    EXPECT_EQ(one[v], v);
    EXPECT_EQ(several[v], on_seam.contains(v) ? kNoId : v);
  }
  // In one pass over the corners what a look around each vertex tells.
  for (const DrawnMesh& drawn : {closed, seamed}) {
    OnlyWedges told(drawn.mesh);
    for (std::uint32_t v = 0; v < drawn.points.size(); ++v) {
      const std::uint32_t before = told[v];
      told.update(drawn.mesh, v);
      EXPECT_EQ(told[v], before) << v;
    }
  }
}

TEST(WedgeClasses, OfTwoVerticesWithoutASeamTheWedgesAreOne) {
  DrawnMesh drawn = closed_fan();
  EXPECT_EQ(collect(drawn, 1, 0), (Members{{0, 1}}));
}

TEST(WedgeClasses, AlongASeamEachSideIsItsOwn) {
  DrawnMesh drawn = seamed_fan();
  EXPECT_EQ(collect(drawn, 0, 1), (Members{{0, 1}, {10, 11}}));
}

TEST(WedgeClasses, OffASeamItsOtherSideStaysAsItIs) {
  DrawnMesh drawn = seamed_fan();
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
  WedgeClasses classes = classes_of(drawn, locks, 0, 1);
  const std::uint32_t upper = classes.class_of(classes.find(1)), lower = classes.class_of(classes.find(10));
  EXPECT_EQ(classes.fixed(upper), kNoId);
  EXPECT_EQ(classes.keeper(upper), 0U);
  EXPECT_EQ(classes.fixed(lower), 11U);
  EXPECT_EQ(classes.keeper(lower), 11U);
  EXPECT_TRUE(classes.joins_locked(10));
  EXPECT_FALSE(classes.joins_locked(0));
  EXPECT_FALSE(classes.joins_locked(99)) << "which is not there";
  locks.is_wedge_locked[10] = 1;
  classes = classes_of(drawn, locks, 0, 1);
  EXPECT_TRUE(classes.joins_locked(11));
  EXPECT_EQ(classes.fixed(classes.class_of(classes.find(11))), 10U);
}

TEST(WedgeClasses, APairIsWhatItsTrianglesWouldTell) {
  DrawnMesh drawn = closed_fan();
  for (const std::uint32_t locked : {kNoId, 0U, 1U}) {
    GroupLocks locks = no_locks(drawn);
    if (locked != kNoId) locks.is_wedge_locked[locked] = 1;
    WedgeClasses pair;
    pair.set_pair(locks, 0, 1);
    const WedgeClasses told = classes_of(drawn, locks, 0, 1);
    EXPECT_EQ(members_of(pair), members_of(told));
    EXPECT_EQ(pair.fixed(0), told.fixed(0));
    EXPECT_EQ(pair.keeper(0), told.keeper(0));
  }
}

TEST(WedgeClasses, AfterTheCollapseTheCornersHaveTheKeepers) {
  DrawnMesh drawn = seamed_fan();
  OnlyWedges only(drawn.mesh);
  const WedgeClasses classes = classes_of(drawn, no_locks(drawn), 0, 1);
  const CollapseStar star = drawn.star(0, 1);
  relabel_wedges(drawn.mesh, star.a, classes);
  relabel_wedges(drawn.mesh, star.b, classes);
  drawn.join(0, 1);
  Ring joined;
  drawn.mesh.gather(0, joined);
  std::multiset<std::uint32_t> wedges;
  for (const std::uint32_t corner : joined.corners()) wedges.insert(drawn.mesh.wedge(corner));
  EXPECT_EQ(wedges, (std::multiset<std::uint32_t>{0, 0, 0, 0, 10, 10, 10, 10}));
  only.update(drawn.mesh, 0);
  EXPECT_EQ(only[0], kNoId) << "the seam still goes through it";
}

}  // namespace
}  // namespace meshlode::builder
