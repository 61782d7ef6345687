// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/lanes.h"

#include <gtest/gtest.h>

#include <limits>

namespace meshlode::builder {
namespace {

TEST(Lanes, CountedAndFoundInEveryPattern) {
  for (std::uint32_t pattern = 0; pattern < 16; ++pattern) {
    LaneMask mask{};
    std::size_t count = 0;
    std::uint32_t first = 4;
    for (std::uint32_t k = 4; k-- > 0;) {
      if ((pattern >> k & 1U) == 0) continue;
      mask[k] = -1;
      first = k;
      ++count;
    }
    EXPECT_EQ(count_lanes(mask), count);
    EXPECT_EQ(any_lane(mask), count > 0);
    if (count > 0) {
      EXPECT_EQ(first_lane(mask), first) << pattern;
    }
  }
}

TEST(Lanes, TheLeastIsInEveryLaneWhereverItWas) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (std::size_t at = 0; at < 4; ++at) {
    Lanes values{3.0F, infinity, 2.5F, 7.0F};
    values[at] = -1.0F;
    const Lanes least = least_lane(values);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(least[k], -1.0F);
  }
}

TEST(Lanes, RotatedByOneTwoAndThree) {
  const LaneMask lanes{10, 11, 12, 13};
  const LaneMask one = rotate_lanes<1>(lanes), two = rotate_lanes<2>(lanes), three = rotate_lanes<3>(lanes);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(one[k], lanes[(k + 1) % 4]);
    EXPECT_EQ(two[k], lanes[(k + 2) % 4]);
    EXPECT_EQ(three[k], lanes[(k + 3) % 4]);
  }
}

}  // namespace
}  // namespace meshlode::builder
