// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/enum_names.h"

#include <array>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "format/names.h"

namespace meshlode {
namespace {

template <class Enum, std::size_t N>
void expect_both_ways(const std::array<EnumName<Enum>, N>& names) {
  std::set<std::string> all;
  for (std::size_t i = 0; i < N; ++i) {
    // Values of the format are numbered from 0 without gaps: each has its name.
    const auto value = static_cast<Enum>(i);
    const char* name = name_in(names, value);
    EXPECT_STRNE(name, "unknown") << i;
    EXPECT_EQ(value_in(names, name), value);
    EXPECT_TRUE(all.insert(name).second) << name;
  }
  EXPECT_STREQ(name_in(names, static_cast<Enum>(N)), "unknown");
  EXPECT_EQ(value_in(names, "unknown"), std::nullopt);
  EXPECT_EQ(value_in(names, ""), std::nullopt);
  EXPECT_EQ(all_names(names).size(), N);
}

TEST(EnumNames, EachValueOfTheFormatHasOneNameAndEachNameOneValue) {
  expect_both_ways(format::kCodecNames);
  expect_both_ways(format::kErrorTierNames);
  expect_both_ways(format::kPromiseNames);
  expect_both_ways(format::kNormalModeNames);
  expect_both_ways(format::kAlphaModeNames);
  expect_both_ways(format::kStuckReasonNames);
}

TEST(EnumNames, ChoicesKeepTheOrderOfTheTable) {
  EXPECT_EQ(all_names(format::kWrittenCodecNames), (std::vector<std::string>{"strips", "none"}));
  EXPECT_EQ(all_names(format::kCodecNames), (std::vector<std::string>{"none", "lz4", "zstd", "strips", "draco"}));
}

}  // namespace
}  // namespace meshlode
