// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/random.h"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

namespace meshlode {
namespace {

// Those of Vigna's splitmix64.c (prng.di.unimi.it), seeded with 1234567.
TEST(SplitMix64, GivesThePublishedNumbers) {
  SplitMix64 random(1234567);
  for (const std::uint64_t expected : {6457827717110365317U, 3203168211198807973U, 9817491932198370423U,
                                       4593380528125082431U, 16408922859458223821U}) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(SplitMix64, DrawsStayInTheirRangeAndReachAllOfIt) {
  SplitMix64 random(7);
  constexpr std::uint32_t kBound = 6;
  std::array<std::uint32_t, kBound> remainders{}, scaled{};
  for (int i = 0; i < 6000; ++i) {
    const std::uint64_t r = random.below(kBound);
    const std::uint32_t s = random.scaled_below(kBound);
    ASSERT_LT(r, kBound);
    ASSERT_LT(s, kBound);
    ++remainders[r];
    ++scaled[s];
    const double unit = random.unit(), both = random.signed_unit(), log = random.log_between(1e-3, 1e3);
    ASSERT_TRUE(unit >= 0.0 && unit < 1.0);
    ASSERT_TRUE(both >= -1.0 && both < 1.0);
    ASSERT_TRUE(log >= 0.999e-3 && log <= 1.001e3);
  }
  // 1000 each, with a standard deviation of 29.
  for (std::uint32_t k = 0; k < kBound; ++k) {
    EXPECT_NEAR(remainders[k], 1000.0, 150.0) << k;
    EXPECT_NEAR(scaled[k], 1000.0, 150.0) << k;
  }
  SplitMix64 one(3), other(3);
  EXPECT_EQ(one.scaled_below(1U << 31U), other.next() >> 33U);  // the upper bits
}

}  // namespace
}  // namespace meshlode
