// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/bar.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

TEST(Bar, FillsInProportion) {
  EXPECT_EQ(bar(0.0, 4, BarStyle::kAscii), "....");
  EXPECT_EQ(bar(0.5, 4, BarStyle::kAscii), "##..");
  EXPECT_EQ(bar(1.0, 4, BarStyle::kAscii), "####");
  EXPECT_EQ(bar(0.0, 4, BarStyle::kBlocks), "    ");
  EXPECT_EQ(bar(0.5, 4, BarStyle::kBlocks), "██  ");
  EXPECT_EQ(bar(1.0, 4, BarStyle::kBlocks), "████");
  EXPECT_EQ(bar(13.0 / 32.0, 4, BarStyle::kBlocks), "█▋  ") << "thirteen eighths";
  EXPECT_EQ(bar(1.0 / 32.0, 4, BarStyle::kBlocks), "▏   ");
}

TEST(Bar, ShowsSomethingForWhatIsThere) {
  EXPECT_EQ(bar(1e-9, 3, BarStyle::kAscii), "#..");
  EXPECT_EQ(bar(1e-9, 3, BarStyle::kBlocks), "▏  ");
}

TEST(Bar, TakesAnyNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double odd : {-1.0, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(bar(odd, 3, BarStyle::kAscii), "...") << odd;
  }
  for (const double odd : {2.0, 1e300, infinity}) EXPECT_EQ(bar(odd, 3, BarStyle::kBlocks), "███") << odd;
}

TEST(Bar, OfAnErrorIsHalfAsLongForAQuarter) {
  EXPECT_EQ(error_fraction(5.0, 5.0), 1.0);
  EXPECT_EQ(error_fraction(1.25, 5.0), 0.5);
  EXPECT_EQ(error_fraction(0.3125, 5.0), 0.25);
  EXPECT_EQ(error_fraction(0.0, 5.0), 0.0);
  EXPECT_GT(error_fraction(5e-30, 5.0), 0.0) << "an error that is there is not shown as none";
  EXPECT_EQ(error_fraction(0.0, 0.0), 0.0);
  EXPECT_EQ(error_fraction(std::numeric_limits<double>::quiet_NaN(), 1.0), 0.0);
}

}  // namespace
}  // namespace meshlode::app
