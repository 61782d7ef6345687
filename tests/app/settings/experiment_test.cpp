// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/experiment.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/settings/settings.h"

namespace meshlode::app {
namespace {

TEST(Experiment, CareIsAllButWhatIsOff) {
  EXPECT_EQ(*builder::parse_care("all"), builder::Care{});
  for (const builder::CareName& one : builder::kCareNames) {
    const auto care = builder::parse_care(std::string(one.name) + "=off");
    ASSERT_TRUE(care) << one.name;
    EXPECT_FALSE((*care).*one.member) << one.name;
    EXPECT_EQ(builder::names_of_missing(*care), std::vector<std::string>{one.name});
  }
  const auto two = builder::parse_care("needles=off,spheres=on,fallback=off");
  ASSERT_TRUE(two);
  EXPECT_EQ(builder::names_of_missing(*two), (std::vector<std::string>{"fallback", "needles"}));
}

TEST(Experiment, OtherTextsAreRefusedInWords) {
  for (const char* text : {"", "needles", "needles=", "needles=no", "needles=off,", ",needles=off", "needels=off",
                           "needles=off;spheres=off", "all,needles=off"}) {
    const auto care = builder::parse_care(text);
    ASSERT_FALSE(care) << text;
    EXPECT_EQ(care.error().code, ErrorCode::kUsage) << text;
    EXPECT_FALSE(care.error().detail.empty()) << text;
  }
  EXPECT_NE(builder::parse_care("needels=off").error().detail.find("the nearest is needles"), std::string::npos);
}

TEST(Experiment, IsWhatTheSettingsSay) {
  SettingLayer layer;
  layer[Setting::kCare] = "spheres=off";
  const auto settled = settle({&layer, 1});
  ASSERT_TRUE(settled);
  EXPECT_FALSE(settled->options.experiment.care.spheres);
  EXPECT_FALSE(settled->options.experiment.is_none());
  EXPECT_TRUE(settle({})->options.experiment.is_none());
  EXPECT_EQ(builder::describe(settled->options.experiment), "without spheres");
  EXPECT_EQ(builder::describe({{.double_quadrics = false, .needles = false}, builder::Simplifier::kOpenMesh}),
            "without double-quadrics, needles; groups reduced by openmesh");
}

}  // namespace
}  // namespace meshlode::app
