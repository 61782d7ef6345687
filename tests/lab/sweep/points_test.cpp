// SPDX-License-Identifier: GPL-3.0-or-later
// Which points a sweep looks at.
#include "lab/sweep/points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace meshlode::lab {
namespace {

constexpr SceneFacts kAll{2.5, true, true};

TEST(SweepPoints, TheBaselineIsFirstAndHasNoArguments) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  const std::vector<Point> points = make_points(knobs);
  ASSERT_FALSE(points.empty());
  EXPECT_EQ(points[0].kind, PointKind::kBaseline);
  EXPECT_TRUE(build_arguments(knobs, points[0]).empty());
  EXPECT_STREQ(build_verb(knobs, points[0]), "build");
  EXPECT_TRUE(draw_arguments(knobs, points[0]).empty());
  EXPECT_EQ(point_label(knobs, points[0]), "baseline");
  EXPECT_EQ(settings_key(knobs, points[0]), "") << "what is measured before there are knobs is found by it";
}

TEST(SweepPoints, EveryKnobHasTwoValuesOrMoreAndAtLeast24PointsThereAre) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  const std::vector<Point> points = make_points(knobs);
  EXPECT_GE(points.size(), 24U);
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    std::set<std::size_t> values;
    for (const Point& point : points) values.insert(point.values[k]);
    EXPECT_GE(values.size(), 2U) << knobs[k].name;
    EXPECT_TRUE(values.contains(knobs[k].usual)) << knobs[k].name;
  }
}

TEST(SweepPoints, OneFactorChangesOneKnobAndACornerMore) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  std::set<std::string> ids;
  std::size_t corners = 0;
  for (const Point& point : make_points(knobs)) {
    const std::size_t changes = changed_knobs(knobs, point).size();
    if (point.kind == PointKind::kBaseline) {
      EXPECT_EQ(changes, 0U);
    }
    if (point.kind == PointKind::kOneFactor) {
      EXPECT_EQ(changes, 1U);
    }
    if (point.kind == PointKind::kCorner) {
      EXPECT_GE(changes, 2U);
    }
    corners += point.kind == PointKind::kCorner ? 1U : 0U;
    EXPECT_TRUE(ids.insert(point_id(knobs, point)).second) << point_label(knobs, point);
    EXPECT_EQ(point_id(knobs, point).size(), 16U);
  }
  EXPECT_GE(corners, 4U);
}

TEST(SweepPoints, AnotherSimplifierIsExperimental) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  std::size_t others = 0;
  for (const Point& point : make_points(knobs)) {
    const std::vector<std::string> arguments = build_arguments(knobs, point);
    const auto option = std::find(arguments.begin(), arguments.end(), "--simplifier");
    if (option == arguments.end()) continue;
    EXPECT_EQ(*(option + 1), "openmesh");
    EXPECT_TRUE(is_experimental(knobs, point));
    EXPECT_STREQ(build_verb(knobs, point), "study");
    EXPECT_EQ(changed_knobs(knobs, point), std::vector<std::string>{"simplifier"});
    ++others;
  }
  EXPECT_EQ(others, 1U);
}

TEST(SweepPoints, AScenesBudgetsAreLeftOutWhereItHasNone) {
  const std::vector<Knob> bare = make_knobs({1.0, false, false});
  for (const Knob& knob : bare) {
    EXPECT_NE(knob.name, "normal_error");
    EXPECT_NE(knob.name, "uv_error");
  }
  // The same settings have the same id, whatever else is in the sweep.
  std::map<std::string, std::string> id_of_key;
  const std::vector<Knob> all = make_knobs({1.0, true, true});
  for (const Point& point : make_points(all)) id_of_key[settings_key(all, point)] = point_id(all, point);
  for (const Point& point : make_points(bare)) {
    EXPECT_EQ(id_of_key.at(settings_key(bare, point)), point_id(bare, point));
  }
}

TEST(SweepPoints, KnobsThatAreLeftOutAreNamed) {
  for (const SceneFacts& facts : {SceneFacts{0.0, false, false}, {1.0, true, false}, {1.0, false, true}, kAll}) {
    std::set<std::string> names;
    for (const Knob& knob : make_knobs(facts)) names.insert(knob.name);
    for (const IdleKnob& knob : find_idle_knobs(facts)) EXPECT_TRUE(names.insert(knob.name).second) << knob.name;
    EXPECT_EQ(names.size(), all_knob_names().size());
  }
  const std::vector<std::string> chosen{"codec", "uv_error"};
  const auto idle = find_idle_knobs({0.0, false, false}, chosen);
  ASSERT_EQ(idle.size(), 1U);
  EXPECT_EQ(idle[0].name, "uv_error");
}

TEST(SweepPoints, PositionBudgetsAreRoundAndNearTheirShareOfTheDiagonal) {
  for (const double diagonal : {1.0, 2.5, 0.0173, 4200.0}) {
    const std::vector<Knob> knobs = make_knobs({diagonal, false, false});
    const auto is_position = [](const Knob& k) { return k.name == "position_error"; };
    const auto knob = std::find_if(knobs.begin(), knobs.end(), is_position);
    ASSERT_NE(knob, knobs.end());
    double before = 0.0;
    for (std::size_t v = 1; v < knob->values.size(); ++v) {
      const double value = std::stod(knob->values[v].word);
      EXPECT_GT(value, before);
      before = value;
      EXPECT_GT(value / diagonal, 0.6 * 1e-5);
      EXPECT_LT(value / diagonal, 1.6 * 1e-3);
    }
  }
}

TEST(SweepPoints, ChosenKnobsAloneAreTurned) {
  const std::vector<std::string> chosen{"care", "codec"};
  const std::vector<Knob> knobs = make_knobs(kAll, chosen);
  ASSERT_EQ(knobs.size(), 2U);
  std::size_t experiments = 0;
  for (const Point& point : make_points(knobs)) {
    const bool is_care = changed_knobs(knobs, point) == std::vector<std::string>{"care"};
    EXPECT_EQ(is_experimental(knobs, point), is_care);
    experiments += is_care ? 1U : 0U;
  }
  EXPECT_EQ(experiments, 4U);
  EXPECT_EQ(all_knob_names().size(), make_knobs(kAll).size());
}

TEST(SweepPoints, APromiseIsBuiltAndDrawn) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  std::set<std::string> promises;
  for (const Point& point : make_points(knobs)) {
    if (changed_knobs(knobs, point) != std::vector<std::string>{"promise"}) continue;
    promises.insert(word_of(knobs, point, "promise"));
    EXPECT_EQ(build_arguments(knobs, point), draw_arguments(knobs, point));
    EXPECT_EQ(build_arguments(knobs, point)[0], "--promise");
    EXPECT_NE(build_key(knobs, point), "");
  }
  EXPECT_EQ(promises, (std::set<std::string>{"appearance", "texels"}));
  EXPECT_EQ(word_of(make_knobs({1.0, false, false}), make_points(make_knobs({1.0, false, false}))[0], "promise"), "");
}

TEST(SweepPoints, KnobsOfAccuracyAreWorthMoreThanAllOthers) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  double least_of_accuracy = 1e9, most_of_others = 0.0;
  std::size_t positions = 0;
  for (const Point& point : make_points(knobs)) {
    if (point.kind == PointKind::kBaseline) continue;
    const std::vector<std::string> changed = changed_knobs(knobs, point);
    positions += changed == std::vector<std::string>{"position_error"} ? 1U : 0U;
    const auto knob = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& k) { return k.name == changed[0]; });
    if (changed.size() == 1 && knob->is_of_accuracy) {
      least_of_accuracy = std::min(least_of_accuracy, point.worth);
    } else {
      most_of_others = std::max(most_of_others, point.worth);
    }
  }
  EXPECT_GT(least_of_accuracy, most_of_others);
  EXPECT_EQ(positions, 5U) << "with the baseline six points of a curve";
}

TEST(SweepPoints, DrawKnobsChangeNoAsset) {
  const std::vector<Knob> knobs = make_knobs(kAll);
  bool has_draw = false;
  for (const Point& point : make_points(knobs)) {
    const auto changed = changed_knobs(knobs, point);
    if (changed != std::vector<std::string>{"pixel_error"}) continue;
    has_draw = true;
    EXPECT_EQ(build_key(knobs, point), "");
    EXPECT_TRUE(build_arguments(knobs, point).empty());
    ASSERT_EQ(draw_arguments(knobs, point).size(), 2U);
    EXPECT_EQ(draw_arguments(knobs, point)[0], "--pixel-error");
    EXPECT_EQ(std::stod(draw_arguments(knobs, point)[1]), number_of(knobs, point, "pixel_error", 0.0));
    EXPECT_NE(number_of(knobs, point, "pixel_error", 1.0), 1.0);
  }
  EXPECT_TRUE(has_draw);
}

}  // namespace
}  // namespace meshlode::lab
