// SPDX-License-Identifier: GPL-3.0-or-later
// Small DAGs where what is farthest off is known.
#include <gtest/gtest.h>

#include "builder/measure/measure_levels.h"
#include "hand_made.h"

namespace meshlode::builder {
namespace {

using test::HandMade;
using test::Soup;

/// A strip of unit width along x.
Soup strip(double from, double to, double height) {
  const Vec3d a(from, 0.0, height), b(to, 0.0, height), c(to, 1.0, height), d(from, 1.0, height);
  return {{a, b, c}, {a, c, d}};
}
Soup operator+(Soup a, const Soup& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// One group: `before` becomes `after`.
HandMade one_group(const Soup& before, const Soup& after) {
  HandMade made;
  made.add_group(1, true);
  made.add_cluster(1, GroupId(1U), after);
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), before);
  return made;
}
void measure(HandMade& made, std::size_t rounds = kMostRounds) {
  Result<CanonicalForm> form = canonical_form(made.mesh, made.dag);
  ASSERT_TRUE(form) << form.error().message();
  made.dag.triangles = form->triangles;
  measure_levels(made.mesh, SourceTree(made.mesh.exact_positions, made.mesh.exact_triangles), *form, 1.0, made.dag,
                 rounds);
}
double error_of(HandMade made) {
  measure(made);
  return made.dag.groups[1].error;
}

TEST(MeasureLevels, HeightsAreMeasuredBothWays) {
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0), strip(0, 2, 0.125))), 0.125, 1e-9);
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0), strip(0, 1.5, 0))), 0.5, 1e-9);  // of the source some is gone
  EXPECT_NEAR(error_of(one_group(strip(0, 1.5, 0), strip(0, 2, 0))), 0.5, 1e-9);  // and here some came
}

TEST(MeasureLevels, APeakInsideATriangleOfTheSourceIsFound) {
  // All corners of the source stay; a valley opens between them.
  const Vec3d a(0.0), b(2.0, 0.0, 0.0), c(2.0, 1.0, 0.0), d(0.0, 1.0, 0.0), low(1.0, 0.5, -0.5);
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0), {{a, b, low}, {b, c, low}, {c, d, low}, {d, a, low}})), 0.5, 1e-3);
}

TEST(MeasureLevels, AFoldIsMeasuredWhereTheSourceIsNot) {
  // A sheet that goes to and back over the strip: its turn is as far as it is high.
  const Soup fold = strip(0, 2, 0) + Soup{{Vec3d(0.5, 0.0, 0.0), Vec3d(1.5, 0.0, 0.75), Vec3d(0.5, 1.0, 0.0)}};
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0), fold)), 0.75, 1e-9);
}

TEST(MeasureLevels, ALoosePieceThatWentIsAsFarAsItIsFromTheRest) {
  const Soup piece{{Vec3d(0.5, 0.5, 1.0), Vec3d(0.75, 0.5, 1.0), Vec3d(0.5, 0.75, 1.25)}};
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0) + piece, strip(0, 2, 0))), 1.25, 1e-9);
}

/// Where the error of a finer group is larger than a piece of the source, the whole of the piece may be farther still.
TEST(MeasureLevels, APieceSmallerThanWhatIsKnownIsMeasuredToo) {
  const Soup piece{{Vec3d(0.5, 0.5, 3.0), Vec3d(0.5625, 0.5, 3.0), Vec3d(0.5, 0.5625, 3.0)}};
  HandMade made;
  made.add_group(2, true);
  made.add_cluster(2, GroupId(1U), strip(0, 2, 0.5));
  made.add_group(1, false);
  made.add_cluster(1, GroupId(2U), strip(0, 2, 0.5));
  made.add_cluster(1, GroupId(2U), piece);
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), strip(0, 2, 0));
  made.add_cluster(0, GroupId(), piece);
  measure(made);
  EXPECT_NEAR(made.dag.groups[2].error, 0.5, 1e-9);
  EXPECT_NEAR(made.dag.groups[1].error, 2.5, 1e-9);
}

TEST(MeasureLevels, ANeedleThatWentIsMeasuredToItsEnd) {
  const Soup needle{{Vec3d(0.5, 0.5, 0.0), Vec3d(0.501953125, 0.5, 0.0), Vec3d(0.5, 0.5, 1.5)}};
  EXPECT_NEAR(error_of(one_group(strip(0, 2, 0) + needle, strip(0, 2, 0))), 1.5, 1e-9);
}

TEST(MeasureLevels, OfAFlatMeshNothingIsLeftButRounding) {
  EXPECT_LE(error_of(one_group(strip(0, 1, 0.25) + strip(1, 2, 0.25), strip(0, 2, 0.25))), 1e-12);
}

TEST(MeasureLevels, AGroupIsTrueBesideWhatAnotherOneHasNotReplacedYet) {
  // What the left group stood for is left to the right one's part, which is there from an error of 1 on only.
  HandMade made;
  made.add_group(1, true);
  made.add_cluster(1, GroupId(1U), strip(0, 0.25, 0));
  made.add_cluster(1, GroupId(2U), strip(0.25, 2, 0.25) + strip(2, 3, 1));
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), strip(0, 2, 0));
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), strip(2, 3, 0));
  measure(made);
  const double left = made.dag.groups[1].error, right = made.dag.groups[2].error;
  EXPECT_NEAR(right, 1.0, 1e-9);
  EXPECT_GE(left, 0.874);
  for (const double threshold : {left, right}) {
    EXPECT_LE(test::sampled_distance(test::source_of(made.mesh), test::cut_of(made.mesh, made.dag, threshold), 40),
              threshold * (1.0 + 1e-9));
  }
}

constexpr int kRidges = 128;
constexpr double kStep = 1.0 / 1024, kWidth = 2.0 / kRidges;

/// Over a strip of length 2, sloped so that it is lowest at one end. They share no edges, so that an overlay leaves
/// the triangles of the strip to a search.
TriangleCorners ridge(int i, double height) {
  const double x = i * kWidth;
  return {Vec3d(x, 0.0, height), Vec3d(x + kWidth, 0.0, height), Vec3d(x + 0.5 * kWidth, 1.0, 0.5 * height)};
}

TEST(MeasureLevels, WhatNoSearchHasEndedCountsByItsBound) {
  HandMade made;
  made.add_group(1, true);
  for (int first = 0; first < kRidges; first += 64) {
    Soup ridges;
    for (int i = first; i < first + 64; ++i) {
      if (i < 70 || i >= 90) ridges.push_back(ridge(i, 18 * kStep));  // in the gap the strip is far from all of them
    }
    made.add_cluster(1, GroupId(1U), ridges);
  }
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), strip(0, 2, 0));
  HandMade ended = made;
  measure(ended);
  measure(made, 0);
  const DagGroup &all = ended.dag.groups[1], &none = made.dag.groups[1];
  EXPECT_DOUBLE_EQ(all.error, all.deviation);
  EXPECT_LT(none.deviation, all.deviation);
  EXPECT_GT(none.error, all.error);
}

/// Two triangles of the source are of two groups, as their corners are. Over both groups' parts they pass a gap, and
/// what is far over the wider one says nothing of the other.
TEST(MeasureLevels, EachGroupOfATriangleAnswersForItsOwnPart) {
  HandMade made;
  made.add_group(2, true);
  for (const std::uint32_t group : {1U, 2U}) {
    Soup ridges;
    for (int i = group == 1 ? 0 : 64; i < (group == 1 ? 64 : kRidges); ++i) {
      const bool is_gap = (i >= 20 && i < 44) || (i >= 90 && i < 98);
      if (!is_gap) ridges.push_back(ridge(i, 18 * kStep));
    }
    made.add_cluster(2, GroupId(group), ridges);
  }
  made.add_group(1, false);
  made.add_cluster(1, GroupId(3U), strip(0, 1, 0));
  made.add_group(1, false);
  made.add_cluster(1, GroupId(3U), strip(1, 2, 0));
  made.add_group(0, false);
  made.add_cluster(0, GroupId(), strip(0, 2, 0));
  measure(made);
  const double left = made.dag.groups[1].error, right = made.dag.groups[2].error;
  EXPECT_GT(left, 0.15);
  EXPECT_LT(right, 0.1);
  for (const double threshold : {left, right}) {
    EXPECT_LE(test::sampled_distance(test::source_of(made.mesh), test::cut_of(made.mesh, made.dag, threshold), 400),
              threshold * 1.002);
  }
}

/// Where one triangle of the source lies over many ridges, as in the test of what no search has ended, and the right
/// group's part is near to it in a gap between two of them alone. `is_shared`: what the triangle is in is of both
/// groups.
HandMade right_part_in_a_gap(int gap, bool is_shared) {
  HandMade made;
  const std::uint32_t level = is_shared ? 2 : 1;
  made.add_group(level, true);
  Soup ridges;
  for (int i = 0; i < kRidges; ++i) {
    if (i != gap && i != gap + 1) ridges.push_back(ridge(i, 18 * kStep));
    if (ridges.size() < 64) continue;
    made.add_cluster(level, GroupId(1U), ridges);
    ridges.clear();
  }
  made.add_cluster(level, GroupId(1U), ridges + strip(-1, -0.5, 20 * kStep));  // known: 20 steps
  made.add_cluster(level, GroupId(2U), strip(gap * kWidth, (gap + 2) * kWidth, 4 * kStep) + strip(5, 6, 1));
  const Soup of_left = strip(0, 2, 0) + strip(-1, -0.5, 0), of_right = strip(5, 6, 0);
  const GroupId own = is_shared ? GroupId(3U) : GroupId();
  made.add_group(level - 1, false);
  made.add_cluster(level - 1, own, of_left);
  made.add_group(level - 1, false);
  made.add_cluster(level - 1, own, of_right);
  if (is_shared) {
    made.add_group(0, false);
    made.add_cluster(0, GroupId(), of_left + of_right);
  }
  return made;
}

TEST(MeasureLevels, AGroupIsTrueWhereASearchLooksBesideItForAnotherOne) {
  for (const bool is_shared : {false, true}) {
    for (int gap = 3; gap < kRidges; gap += 20) {
      HandMade made = right_part_in_a_gap(gap, is_shared);
      measure(made);
      const double left = made.dag.groups[1].error;
      EXPECT_NEAR(made.dag.groups[2].error, 1.0, 1e-9);
      EXPECT_GT(left, 22 * kStep);
      EXPECT_LE(test::sampled_distance(test::source_of(made.mesh), test::cut_of(made.mesh, made.dag, left), 400),
                left * 1.002)  // searches go on to what is so much farther
          << gap << (is_shared ? " of both groups" : "");
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
