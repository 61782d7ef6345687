// SPDX-License-Identifier: GPL-3.0-or-later
// The exact predicates against integers: every float here is a small integer times a power of two, so that 128-bit
// arithmetic knows the answer.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "judge/validate/exact.h"

namespace meshlode::judge {
namespace {

__extension__ using Int128 = __int128;

TEST(Exact, BallsThatTouchFromInsideAreContained) {
  EXPECT_TRUE(contains_ball({{0, 0, 0}, 5}, {{3, 0, 0}, 2}));
  EXPECT_TRUE(contains_ball({{0, 0, 0}, 5}, {{3, 4, 0}, 0}));
  EXPECT_TRUE(contains_ball({{1, 2, 3}, 4}, {{1, 2, 3}, 4}));
  EXPECT_TRUE(contains_point({{0, 0, 0}, 13}, {3.0, 4.0, 12.0}));
}

TEST(Exact, OneUlpDecides) {
  const float below = std::nextafter(5.0F, 0.0F);
  EXPECT_FALSE(contains_ball({{0, 0, 0}, below}, {{3, 0, 0}, 2}));
  EXPECT_FALSE(contains_ball({{0, 0, 0}, 5}, {{3, 0, 0}, std::nextafter(2.0F, 3.0F)}));
  EXPECT_FALSE(contains_ball({{0, 0, 0}, 5}, {{std::nextafter(3.0F, 4.0F), 0, 0}, 2}));
  EXPECT_FALSE(contains_point({{0, 0, 0}, std::nextafter(13.0F, 0.0F)}, {3.0, 4.0, 12.0}));
}

TEST(Exact, DifferencesBeyondADoubleAreNotLost) {
  // A centre of 2^60 and one of 2^-60: their difference has more bits than a double, and the sphere misses by 2^-60.
  const float large = 0x1p60F;
  EXPECT_FALSE(contains_ball({{large, 0, 0}, large}, {{-0x1p-60F, 0, 0}, 0}));
  EXPECT_TRUE(contains_ball({{large, 0, 0}, large}, {{0x1p-60F, 0, 0}, 0}));
  EXPECT_TRUE(contains_ball({{large, 0, 0}, large}, {{0, 0, 0}, 0}));
  EXPECT_FALSE(contains_ball({{large, 0, 0}, large}, {{0, 0x1p-60F, 0}, 0}));
}

TEST(Exact, DenormalSpheresAreToldApart) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_TRUE(contains_ball({{0, 0, 0}, 2 * tiny}, {{tiny, 0, 0}, tiny}));
  EXPECT_FALSE(contains_ball({{0, 0, 0}, tiny}, {{tiny, 0, 0}, tiny}));
  EXPECT_FALSE(contains_point({{0, 0, 0}, tiny}, {double{tiny}, double{tiny}, 0.0}));
}

TEST(Exact, RandomBallsAgreeWithIntegers) {
  SplitMix64 random(1);
  int contained = 0;
  for (int i = 0; i < 200000; ++i) {
    // Radii are set to the floor or the ceiling of the exact distance, so that half the cases are within one unit.
    std::int64_t d[3];
    for (std::int64_t& v : d) v = static_cast<std::int64_t>(random.below(1U << 21)) - (1 << 20);
    const Int128 squared =
        static_cast<Int128>(d[0]) * d[0] + static_cast<Int128>(d[1]) * d[1] + static_cast<Int128>(d[2]) * d[2];
    const auto inner = static_cast<std::int64_t>(random.below(1U << 20));
    const auto outer = inner + static_cast<std::int64_t>(std::sqrt(static_cast<double>(squared))) +
                       static_cast<std::int64_t>(random.below(3)) - 1;
    const Int128 room = outer - inner;
    const bool truth = room >= 0 && squared <= room * room;
    const float scale = std::ldexp(1.0F, static_cast<int>(random.below(120)) - 60);
    const ExactBall a{{0, 0, 0}, static_cast<float>(outer) * scale};
    const ExactBall b{
        {static_cast<float>(d[0]) * scale, static_cast<float>(d[1]) * scale, static_cast<float>(d[2]) * scale},
        static_cast<float>(inner) * scale};
    ASSERT_EQ(contains_ball(a, b), truth) << "case " << i;
    contained += truth ? 1 : 0;
  }
  EXPECT_GT(contained, 50000);
  EXPECT_LT(contained, 150000);
}

TEST(Exact, CancellationKeepsTheSign) {
  const ExactBall ball{{0, 0, 0}, 0x1p60F};
  EXPECT_TRUE(contains_point(ball, {0x1p60, 0.0, 0.0}));
  EXPECT_FALSE(contains_point(ball, {0x1p60, 0x1p-100, 0.0}));
  EXPECT_FALSE(contains_point(ball, {0x1p60, 0.0, -0x1p-100}));
  EXPECT_TRUE(contains_point(ball, {0x1p60 * 0.6, 0x1p60 * 0.8 - 0x1p8, 0.0}));
}

}  // namespace
}  // namespace meshlode::judge
