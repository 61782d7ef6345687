// SPDX-License-Identifier: GPL-3.0-or-later
// A plan keeps its budget, and what is worth more comes first.
#include "study/sweep/plan.h"

#include <gtest/gtest.h>

#include <vector>

namespace meshlode::study {
namespace {

constexpr BaselineCost kCost{2.0, 3.0, 0.1};

double sum_of_chosen(const std::vector<PlannedPoint>& plan) {
  double sum = 0.0;
  for (const PlannedPoint& one : plan) sum += one.is_chosen ? one.estimate : 0.0;
  return sum;
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
    EXPECT_LE(sum_of_chosen(plan), budget);
    std::size_t chosen = 0;
    for (const PlannedPoint& one : plan) chosen += one.is_chosen ? 1U : 0U;
    EXPECT_GE(chosen, before);
    before = chosen;
    EXPECT_TRUE(plan[0].is_chosen);
    // Nothing that is worth less and costs as much is there while something is left out.
    for (std::size_t a = 0; a < points.size(); ++a) {
      for (std::size_t b = 0; b < points.size(); ++b) {
        if (plan[a].is_chosen || !plan[b].is_chosen || points[b].kind == PointKind::kBaseline) continue;
        EXPECT_FALSE(points[a].worth > points[b].worth && plan[a].estimate <= plan[b].estimate)
            << point_label(knobs, points[a]) << " against " << point_label(knobs, points[b]);
      }
    }
  }
  EXPECT_EQ(before, points.size());
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
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (build_key(knobs, points[i]).empty()) {
      EXPECT_DOUBLE_EQ(plan[i].estimate, 0.3);
    } else {
      EXPECT_GT(plan[i].estimate, 3.3);
    }
  }
}

}  // namespace
}  // namespace meshlode::study
