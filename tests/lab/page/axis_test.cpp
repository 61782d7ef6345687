// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/axis.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode::lab::page {
namespace {

using Ticks = std::vector<double>;

TEST(Axis, LinearTicksAreMultiplesOfOneTwoOrFive) {
  EXPECT_EQ(linear_ticks(0.0, 10.0, 6), (Ticks{0.0, 2.0, 4.0, 6.0, 8.0, 10.0}));
  EXPECT_EQ(linear_ticks(0.0, 1.0, 11), (Ticks{0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}))
      << "each the nearest double, not a sum of tenths";
  EXPECT_EQ(linear_ticks(-3.0, 17.0, 5), (Ticks{0.0, 5.0, 10.0, 15.0}));
  EXPECT_EQ(linear_ticks(1e6, 1e6 + 4.0, 5), (Ticks{1e6, 1e6 + 1.0, 1e6 + 2.0, 1e6 + 3.0, 1e6 + 4.0}));
}

TEST(Axis, LogTicksAreRoundNumbersOfEachDecade) {
  EXPECT_EQ(log_ticks(1.0, 100.0, 7), (Ticks{1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}));
  EXPECT_EQ(log_ticks(1.0, 1000.0, 7), (Ticks{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0}));
  EXPECT_EQ(log_ticks(1e-6, 1.0, 7), (Ticks{1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0}));
  EXPECT_EQ(log_ticks(1e-12, 1.0, 7), (Ticks{1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 1.0}));
  EXPECT_EQ(log_ticks(3.0, 4.0, 6), linear_ticks(3.0, 4.0, 6)) << "less than a decade";
}

TEST(Axis, TicksOfAnyRangeAreFewAndInside) {
  test::Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10.0, random.between(-290.0, 290.0));
    const double low = size * random.between(-1.0, 1.0), high = low + size * random.between(1e-9, 2.0);
    const std::size_t most = 2 + static_cast<std::size_t>(random.between(0.0, 9.0));
    for (const bool is_log : {false, true}) {
      if (!(low < high) || (is_log && low <= 0.0)) continue;
      const Ticks ticks = is_log ? log_ticks(low, high, most) : linear_ticks(low, high, most);
      ASSERT_LE(ticks.size(), most) << low << " " << high;
      for (std::size_t k = 0; k < ticks.size(); ++k) {
        ASSERT_GE(ticks[k], low);
        ASSERT_LE(ticks[k], high);
        if (k > 0) {
          ASSERT_GT(ticks[k], ticks[k - 1]);
        }
      }
    }
  }
}

TEST(Axis, LinearAxesEndAtTicks) {
  const Axis axis = fit_axis({"x", "", Scale::kLinear, true, 6}, Ticks{3.0, 9.5});
  EXPECT_EQ(axis.low, 0.0);
  EXPECT_EQ(axis.high, 10.0);
  EXPECT_EQ(axis.place(5.0), 0.5);
}

TEST(Axis, LogAxesPutEqualRatiosAtEqualDistances) {
  const Axis axis = fit_axis({"x", "", Scale::kLog}, Ticks{1.0, 10.0, 100.0});
  EXPECT_NEAR(axis.place(10.0) - axis.place(1.0), axis.place(100.0) - axis.place(10.0), 1e-12);
  EXPECT_NEAR(axis.place(10.0), 0.5, 1e-12);
  EXPECT_GT(axis.place(1.0), 0.0);
  EXPECT_LT(axis.place(100.0), 1.0);
}

TEST(Axis, ZeroHasItsPlaceOnALogAxis) {
  const Axis axis = fit_axis({"x", "", Scale::kLog}, Ticks{0.0, 1e-5, 1e-3});
  EXPECT_TRUE(axis.has_zero);
  EXPECT_EQ(axis.place(0.0), 0.0);
  EXPECT_GT(axis.place(1e-5), 0.1);
}

TEST(Axis, TakesAnyNumbers) {
  const double infinity = std::numeric_limits<double>::infinity(), nothing = std::numeric_limits<double>::quiet_NaN();
  for (const Scale scale : {Scale::kLinear, Scale::kLog}) {
    for (const Ticks& values : {Ticks{}, Ticks{0.0}, Ticks{5.0}, Ticks{-1.0, -1.0}, Ticks{infinity, nothing, 2.0},
                                Ticks{1e-300, 1e300}, Ticks{-1e300, 1e300}, Ticks{5e-324, 1e-323}, Ticks{1e308}}) {
      const Axis axis = fit_axis({"x", "", scale}, values);
      ASSERT_LT(axis.low, axis.high);
      ASSERT_TRUE(std::isfinite(axis.low) && std::isfinite(axis.high));
      ASSERT_LE(axis.ticks.size(), 7U);
      for (const double value : values) {
        if (!(std::abs(value) <= 1e300)) continue;
        ASSERT_GE(axis.place(value), 0.0) << value;
        ASSERT_LE(axis.place(value), 1.0) << value;
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::lab::page
