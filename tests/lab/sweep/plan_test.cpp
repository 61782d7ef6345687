// SPDX-License-Identifier: GPL-3.0-or-later
// A plan keeps its budget, and what is worth more comes first.
#include "lab/sweep/plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

namespace meshlode::lab {
namespace {

constexpr BaselineCost kCost{2.0, 3.0, 0.1};

double first_of_chosen(const std::vector<PlannedPoint>& plan) {
  double sum = 0.0;
  for (const PlannedPoint& one : plan) sum += one.is_chosen ? one.first : 0.0;
  return sum;
}

/// Names of the knobs of accuracy of which a point beside the baseline is chosen.
std::set<std::string> accuracy_turned(const std::vector<Knob>& knobs, const std::vector<Point>& points,
                                      const std::vector<PlannedPoint>& plan) {
  std::set<std::string> turned;
  for (const PlannedPoint& one : plan) {
    const Point& point = points[one.point];
    if (!one.is_chosen || point.kind != PointKind::kOneFactor) continue;
    for (std::size_t k = 0; k < knobs.size(); ++k) {
      if (knobs[k].is_of_accuracy && point.values[k] != knobs[k].usual) turned.insert(knobs[k].name);
    }
  }
  return turned;
}

TEST(SweepPlan, WithoutABudgetEverythingIsChosen) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  const auto plan = plan_points(knobs, points, kCost, 3, 0.0);
  ASSERT_EQ(plan.size(), points.size());
  for (const PlannedPoint& one : plan) EXPECT_TRUE(one.is_chosen);
}

TEST(SweepPlan, KeepsTheBudgetAndLosesTheLeastWorthFirst) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  std::size_t before = 0;
  for (const double budget : {30.0, 60.0, 120.0, 240.0, 1000.0}) {
    const auto plan = plan_points(knobs, points, kCost, 3, budget);
    EXPECT_LE(first_of_chosen(plan), budget);
    std::size_t chosen = 0;
    for (const PlannedPoint& one : plan) chosen += one.is_chosen ? 1U : 0U;
    EXPECT_GE(chosen, before);
    before = chosen;
    EXPECT_TRUE(plan[0].is_chosen);
    // Nothing that is worth less and costs as much is there while something is left out.
    for (const PlannedPoint& a : plan) {
      for (const PlannedPoint& b : plan) {
        const Point &of_a = points[a.point], &of_b = points[b.point];
        if (a.is_chosen || !b.is_chosen || of_b.kind == PointKind::kBaseline) continue;
        EXPECT_FALSE(of_a.worth > of_b.worth && a.estimate <= b.estimate && a.first <= b.first)
            << point_label(knobs, of_a) << " against " << point_label(knobs, of_b);
      }
    }
  }
  EXPECT_EQ(before, points.size());
}

TEST(SweepPlan, AShortBudgetTurnsEveryKnobOfAccuracyOnceBeforeAnythingElse) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  // Eight builds and measurements, one of them of a promise, fit; three rounds of them do not.
  const auto plan = plan_points(knobs, points, {1.0, 2.0, 0.1}, 3, 40.0);
  EXPECT_EQ(accuracy_turned(knobs, points, plan),
            (std::set<std::string>{"preset", "error_tier", "position_error", "normal_error", "uv_error", "promise"}));
  EXPECT_LE(first_of_chosen(plan), 36.0);
  for (const PlannedPoint& one : plan) {
    const Point& point = points[one.point];
    if (!one.is_chosen || point.kind == PointKind::kBaseline) continue;
    const std::vector<std::string> changed = changed_knobs(knobs, point);
    ASSERT_EQ(changed.size(), 1U) << point_label(knobs, point);
    const auto knob = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& k) { return k.name == changed[0]; });
    EXPECT_TRUE(knob->is_of_accuracy) << point_label(knobs, point);
  }
}

TEST(SweepPlan, WhatFirstRoundsLeaveGoesToMorePoints) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  // The baseline took three times as long as the others do.
  auto plan = plan_points(knobs, points, {3.0, 6.0, 0.3}, 3, 60.0);
  EXPECT_LT(accuracy_turned(knobs, points, plan).size(), 6U);
  const double first = first_of_chosen(plan);
  auto same = plan;
  EXPECT_EQ(choose_more(knobs, points, {3.0, 6.0, 0.3}, 3, 60.0, first, same), 0U) << "it took what was estimated";
  EXPECT_GT(choose_more(knobs, points, {3.0, 6.0, 0.3}, 3, 60.0, first / 3.0, plan), 0U);
  EXPECT_EQ(accuracy_turned(knobs, points, plan).size(), 6U);
}

TEST(SweepPlan, WhatIsMeasuredFirstIsWorthMost) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  const auto plan = plan_points(knobs, points, kCost, 3, 0.0);
  EXPECT_EQ(plan[0].point, 0U);
  std::set<std::size_t> seen;
  for (const PlannedPoint& one : plan) seen.insert(one.point);
  EXPECT_EQ(seen.size(), points.size());
  for (std::size_t r = 2; r < plan.size(); ++r) EXPECT_GE(points[plan[r - 1].point].worth, points[plan[r].point].worth);
}

TEST(SweepPlan, TheBaselineIsChosenWhateverItCosts) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  const auto plan = plan_points(knobs, points, {100.0, 100.0, 1.0}, 3, 10.0);
  for (std::size_t i = 0; i < plan.size(); ++i) EXPECT_EQ(plan[i].is_chosen, i == 0) << i;
}

TEST(SweepPlan, AnAssetThatIsBuiltAnywayCostsItsFramesAlone) {
  const auto knobs = make_knobs({1.0, true, true});
  const auto points = make_points(knobs);
  const auto plan = plan_points(knobs, points, kCost, 3, 0.0);
  for (const PlannedPoint& one : plan) {
    if (points[one.point].kind == PointKind::kBaseline) continue;
    if (build_key(knobs, points[one.point]).empty()) {
      EXPECT_DOUBLE_EQ(one.estimate, 0.3);
    } else {
      EXPECT_GT(one.estimate, 3.3);
    }
  }
}

TEST(SweepPlan, SamplesAndPicturesFollowTheBudgetAndTheScene) {
  const Fineness full = choose_fineness(0.0, 6, 55000);
  EXPECT_EQ(full.samples, 100000U);
  EXPECT_EQ(full.searches, Searches::kAll);
  EXPECT_EQ(full.width, 640U);
  std::uint64_t before = 0;
  for (const double budget : {1.0, 30.0, 60.0, 90.0, 300.0, 3600.0, 1e6}) {
    const Fineness small = choose_fineness(budget, 1, 5000), large = choose_fineness(budget, 6, 55000);
    EXPECT_GE(small.samples, before) << budget;
    EXPECT_GE(small.samples, large.samples) << budget;
    EXPECT_GE(large.samples, 2000U) << budget;
    before = small.samples;
  }
  EXPECT_EQ(before, 100000U);
  EXPECT_EQ(choose_fineness(90.0, 6, 55000).searches, Searches::kFew);
  EXPECT_EQ(choose_fineness(90.0, 6, 55000).width, 320U);
  EXPECT_EQ(choose_fineness(3600.0, 6, 55000).searches, Searches::kAll);
  EXPECT_EQ(choose_fineness(3600.0, 6, 55000).width, 640U);
}

}  // namespace
}  // namespace meshlode::lab
