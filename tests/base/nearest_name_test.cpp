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

TEST(NearestName, IsOnlySuggestedWhereItMayHaveBeenMeant) {
  const std::vector<std::string> known = {"validate", "build", "zstd", "a"};
  EXPECT_EQ(find_near_name("biuld", known), "build");
  EXPECT_EQ(find_near_name("zst", known), "zstd");
  EXPECT_EQ(find_near_name("VLIDATE", known), "validate");
  EXPECT_FALSE(find_near_name("frobnicate", known));
  EXPECT_FALSE(find_near_name("b", known)) << "one letter for another";
  EXPECT_FALSE(find_near_name("", known));
  EXPECT_FALSE(find_near_name("build", {}));
  EXPECT_EQ(unknown_choice("zst", known),
            "unknown value 'zst'; choose validate, build, zstd or a; the nearest is zstd");
  EXPECT_EQ(nearest_or_all("gzip8", known), "; choose validate, build, zstd or a");
}

}  // namespace
}  // namespace meshlode
