// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/nearest_name.h"

#include <gtest/gtest.h>

namespace meshlode {
namespace {

TEST(NearestName, DistancesAreThoseOfThePaper) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("abc", "abc"), 0U);
  EXPECT_EQ(edit_distance("Normal_Error", "normal-error"), 0U);
}

TEST(NearestName, FindsTheFirstOfTheNearest) {
  const std::vector<std::string> known{"grid", "codec", "preset", "presen"};
  EXPECT_EQ(nearest_name("grit", known), "grid");
  EXPECT_EQ(nearest_name("PRESET", known), "preset");
  EXPECT_EQ(nearest_name("prese", known), "preset") << "of equally near ones the first";
  EXPECT_EQ(nearest_name("", known), "grid");
  EXPECT_FALSE(nearest_name(std::string(1U << 20U, 'x'), known).empty())
      << "a long word costs no more than a short one";
}

}  // namespace
}  // namespace meshlode
