// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/uv_grid.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode::builder {
namespace {

UvRange range_of(float a, float b) {
  UvRange range;
  range.add(a);
  range.add(b);
  return range;
}

float decode(std::int32_t q, std::int32_t log2) {
  return static_cast<float>(std::ldexp(double(q), log2));
}

TEST(UvGrid, TheStepIsTheCoarsestPowerOfTwoThatKeepsTheError) {
  EXPECT_EQ(choose_uv_log2(range_of(0.0F, 1.0F), 0x1p-17), -16);
  EXPECT_EQ(choose_uv_log2(range_of(0.0F, 1.0F), 0x1.8p-17), -16);
  EXPECT_EQ(choose_uv_log2(range_of(0.0F, 1.0F), 0x1.fffp-18), -17);
  EXPECT_EQ(choose_uv_log2(UvRange{}, 0.125), -2);
}

TEST(UvGrid, TheDefaultIsAnEighthOfATexelAndFinerForSmallCharts) {
  EXPECT_EQ(default_uv_error(range_of(0.0F, 1.0F)), 1.0 / (8 * 2048));
  EXPECT_EQ(default_uv_error(range_of(-50.0F, 50.0F)), 1.0 / (8 * 2048)) << "tiling does not coarsen a tile";
  EXPECT_EQ(default_uv_error(range_of(0.25F, 0.5F)), 0.25 / (8 * 2048));
  EXPECT_EQ(default_uv_error(range_of(0.1F, 0.1F)), 1.0 / (8 * 2048));
  EXPECT_EQ(default_uv_error(UvRange{}), 1.0 / (8 * 2048));
}

TEST(UvGrid, EveryDecodedValueIsExactAndWithinHalfAStep) {
  test::Random random(3);
  for (const float size : {1e-38F, 1e-20F, 1e-6F, 1.0F, 777.0F, 1e6F, 1e20F, 3e38F}) {
    for (const float offset : {0.0F, 1.0F, 1e6F}) {
      UvRange range;
      std::vector<float> values;
      for (int i = 0; i < 200; ++i) {
        const float value = offset + size * static_cast<float>(random.signed_unit());
        if (!std::isfinite(value)) continue;
        values.push_back(value);
        range.add(value);
      }
      const std::int32_t log2 = choose_uv_log2(range, 0x1p-17);
      ASSERT_GE(log2, kMinUvLog2);
      ASSERT_LE(log2, kMaxUvLog2);
      for (const float value : values) {
        const std::int32_t q = quantize_uv(value, log2);
        ASSERT_LE(std::abs(q), kMaxUvInteger);
        ASSERT_EQ(double(decode(q, log2)), std::ldexp(double(q), log2)) << "exact in float";
        ASSERT_LE(std::abs(double(value) - std::ldexp(double(q), log2)), std::ldexp(0.5, log2)) << value;
      }
    }
  }
}

// At 1e6 a float itself has no more than 2^-4: the grid keeps every value that the source could say.
TEST(UvGrid, LargeOffsetsKeepEveryFloat) {
  const std::int32_t log2 = choose_uv_log2(range_of(1e6F, 1e6F + 1.0F), 0x1p-17);
  EXPECT_EQ(log2, -4);
  for (float value = 1e6F; value <= 1e6F + 1.0F; value = std::nextafter(value, 2e6F)) {
    EXPECT_EQ(decode(quantize_uv(value, log2), log2), value);
  }
}

TEST(UvGrid, WhatIsNotFiniteBecomesZeroAndWidensNothing) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  UvRange range = range_of(0.0F, 1.0F);
  range.add(inf);
  range.add(-inf);
  range.add(nan);
  EXPECT_EQ(choose_uv_log2(range, 0x1p-17), -16);
  for (const float value : {inf, -inf, nan}) EXPECT_EQ(quantize_uv(value, -16), 0);
}

TEST(UvGrid, TheLargestFloatsFit) {
  const float most = std::numeric_limits<float>::max();
  const std::int32_t log2 = choose_uv_log2(range_of(-most, most), 0x1p-17);
  EXPECT_EQ(log2, kMaxUvLog2);
  EXPECT_EQ(decode(quantize_uv(most, log2), log2), most);
  EXPECT_EQ(decode(quantize_uv(-most, log2), log2), -most);
}

}  // namespace
}  // namespace meshlode::builder
