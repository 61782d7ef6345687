// SPDX-License-Identifier: GPL-3.0-or-later
// PSNR against closed forms.
#include "app/compare/pictures.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Pictures, EqualOnesHaveNoFiniteRatio) {
  const Bytes picture{1, 2, 3, 255, 4, 5, 6, 255};
  const PictureDifference d = compare_pictures(picture, picture);
  EXPECT_FALSE(d.psnr.has_value());
  EXPECT_EQ(d.pixels, 2U);
  EXPECT_EQ(d.differing_pixels, 0U);
  EXPECT_EQ(d.max_difference, 0U);
  EXPECT_EQ(d.differing_share(), 0.0);
  EXPECT_EQ(compare_pictures({}, {}).differing_share(), 0.0);
}

TEST(Pictures, ADifferenceOfOneEverywhereIs48Decibels) {
  const Bytes a(4 * 100, 10), b(4 * 100, 11);
  const PictureDifference d = compare_pictures(a, b);
  ASSERT_TRUE(d.psnr.has_value());
  EXPECT_NEAR(*d.psnr, 20.0 * std::log10(255.0), 1e-12);
  EXPECT_EQ(d.differing_share(), 1.0);
  EXPECT_EQ(d.max_difference, 1U);
}

TEST(Pictures, OneChannelOfOnePixelCountsByItsShare) {
  Bytes a(4 * 10, 0), b(4 * 10, 0);
  b[4 * 7 + 1] = 255;
  const PictureDifference d = compare_pictures(a, b);
  ASSERT_TRUE(d.psnr.has_value());
  EXPECT_NEAR(*d.psnr, 10.0 * std::log10(30.0), 1e-12);  // MSE = 255² / 30
  EXPECT_EQ(d.differing_pixels, 1U);
  EXPECT_EQ(d.differing_share(), 0.1);
  EXPECT_EQ(d.max_difference, 255U);
  const PictureDifference back = compare_pictures(b, a);
  EXPECT_EQ(back.psnr, d.psnr);
}

TEST(Pictures, AlphaIsNotLookedAt) {
  EXPECT_FALSE(compare_pictures(Bytes{1, 2, 3, 0}, Bytes{1, 2, 3, 255}).psnr.has_value());
}

}  // namespace
}  // namespace meshlode::app
