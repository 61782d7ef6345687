// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/experiment/experiment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/vec.h"
#include "builder/builder.h"
#include "builder/stage_options.h"
#include "lab/samples/samples.h"
#include "support/random.h"

namespace meshlode::lab {
namespace {

TEST(Experiment, CareIsAllButWhatIsOff) {
  EXPECT_EQ(*parse_care("all"), Care{});
  for (const CareName& one : kCareNames) {
    const auto care = parse_care(std::string(one.name) + "=off");
    ASSERT_TRUE(care) << one.name;
    EXPECT_FALSE((*care).*one.member) << one.name;
    EXPECT_EQ(hooks_of({*care, Simplifier::kOwn}).words, std::string("without ") + one.name);
  }
  const auto two = parse_care("needles=off,spheres=on,fallback=off");
  ASSERT_TRUE(two);
  EXPECT_EQ(hooks_of({*two, Simplifier::kOwn}).words, "without fallback, needles");
}

TEST(Experiment, OtherTextsAreRefusedInWords) {
  for (const char* text : {"", "needles", "needles=", "needles=no", "needles=off,", ",needles=off", "needels=off",
                           "needles=off;spheres=off", "all,needles=off"}) {
    const auto care = parse_care(text);
    ASSERT_FALSE(care) << text;
    EXPECT_EQ(care.error().code, ErrorCode::kUsage) << text;
    EXPECT_FALSE(care.error().detail.empty()) << text;
  }
  EXPECT_NE(parse_care("needels=off").error().detail.find("the nearest is needles"), std::string::npos);
}

TEST(Experiment, TheAssetSaysWhatItIs) {
  EXPECT_TRUE(Experiment{}.is_none());
  const builder::BuildHooks hooks = hooks_of({{.double_quadrics = false, .needles = false}, Simplifier::kOpenMesh});
  EXPECT_EQ(hooks.words, "without double-quadrics, needles; groups reduced by openmesh");
  EXPECT_EQ(hooks.record, R"({"care_left_out":["double-quadrics","needles"],"simplifier":"openmesh"})");
  EXPECT_FALSE(hooks.separates_needles);
  builder::PipelineOptions options;
  options.hooks = &hooks;
  options.codec = format::Codec::kNone;  // META can be read as it lies in the file
  builder::PipelineReport report;
  const auto bytes = builder::build_lode(lab::as_scene(lab::as_mesh(lab::make_rock(12))), options, {}, report);
  ASSERT_TRUE(bytes);
  const std::string text(bytes->begin(), bytes->end());
  EXPECT_NE(text.find("\"experimental\":" + hooks.record), std::string::npos);
}

/// Each is felt, and none is the usual build.
TEST(Experiment, EachCareAndTheOtherSimplifierGiveAnAssetOfTheirOwn) {
  std::set<std::vector<std::uint8_t>> assets;
  const auto add = [&](const builder::BuildHooks* hooks) {
    builder::PipelineOptions options;
    options.hooks = hooks;
    builder::PipelineReport report;
    auto bytes = builder::build_lode(lab::as_scene(lab::as_mesh(lab::make_rock(20))), options, {}, report);
    ASSERT_TRUE(bytes);
    assets.insert(std::move(*bytes));
  };
  add(nullptr);
  for (const CareName& one : kCareNames) {
    Experiment experiment;
    experiment.care.*one.member = false;
    const builder::BuildHooks hooks = hooks_of(experiment);
    add(&hooks);
  }
  const builder::BuildHooks hooks = hooks_of({Care{}, Simplifier::kOpenMesh});
  add(&hooks);
  EXPECT_EQ(assets.size(), kCareNames.size() + 2);
}

TEST(Experiment, WithoutSpheresTheBallIsAboutTheMiddleOfTheBox) {
  const builder::BuildHooks hooks = hooks_of({{.spheres = false}, Simplifier::kOwn});
  test::RandomSource random(33);
  for (int i = 0; i < 300; ++i) {
    std::vector<builder::Ball> balls;
    for (std::uint32_t n = 2 + random.below(30); n > 0; --n) balls.push_back({random.in_cube(1.0), random.unit()});
    Vec3d low(HUGE_VAL), high(-HUGE_VAL);
    double radius = 0.0;
    for (const builder::Ball& b : balls) {
      low = glm::min(low, b.center - Vec3d(b.radius));
      high = glm::max(high, b.center + Vec3d(b.radius));
    }
    const builder::Ball ball = hooks.enclosing_ball(balls);
    for (const builder::Ball& b : balls) radius = std::max(radius, glm::length(b.center - ball.center) + b.radius);
    EXPECT_LT(glm::length(ball.center - (low + high) * 0.5), 1e-14);
    EXPECT_NEAR(ball.radius, radius, 1e-14);
  }
}

TEST(Experiment, OpenMeshsDecimaterPromisesNoTopologyAndNoBorders) {
  const builder::BuildHooks hooks = hooks_of({Care{}, Simplifier::kOpenMesh});
  builder::PipelineOptions options;
  options.keep_topology = true;
  EXPECT_TRUE(check_options(options, 0).ok());
  options.hooks = &hooks;
  EXPECT_FALSE(check_options(options, 0).ok());
  options.keep_topology = false;
  EXPECT_TRUE(check_options(options, 1).ok());
  options.lock_borders = true;
  EXPECT_FALSE(check_options(options, 1).ok());
}

}  // namespace
}  // namespace meshlode::lab
