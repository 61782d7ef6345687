// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/textures/shrink.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/image_size.h"

namespace meshlode::app {
namespace {

constexpr std::uint32_t kBlack = 0xFF000000U, kWhite = 0xFFFFFFFFU;

draw::DecodedImage image_of(std::uint32_t width, std::uint32_t height, std::vector<std::uint32_t> texels) {
  return {width, height, std::move(texels)};
}

std::array<std::uint32_t, 4> channels(std::uint32_t texel) {
  return {texel & 255U, texel >> 8U & 255U, texel >> 16U & 255U, texel >> 24U};
}

TEST(Shrink, SizesKeepTheirRatio) {
  EXPECT_EQ(fit_size(2048, 1024, 1024), std::pair(1024U, 512U));
  EXPECT_EQ(fit_size(1000, 3000, 100), std::pair(33U, 100U));
  EXPECT_EQ(fit_size(16384, 1, 4), std::pair(4U, 1U));
  EXPECT_EQ(fit_size(512, 512, 1024), std::pair(512U, 512U)) << "nothing grows";
  EXPECT_EQ(fit_size(512, 300, 0), std::pair(512U, 300U));
}

TEST(Shrink, AChequerOfBlackAndWhiteIsHalfTheLight) {
  // Half of the light is level 188 of sRGB (IEC 61966-2-1): 0.5 = ((188.0 / 255 + 0.055) / 1.055)^2.4, nearly.
  const auto chequer = image_of(2, 2, {kBlack, kWhite, kWhite, kBlack});
  EXPECT_EQ(channels(shrink(chequer, 1, 1, TexelKind::kColor).texels[0]), (std::array{188U, 188U, 188U, 255U}));
  EXPECT_EQ(channels(shrink(chequer, 1, 1, TexelKind::kData).texels[0]), (std::array{128U, 128U, 128U, 255U}));
}

TEST(Shrink, TransparentTexelsDoNotColourOthers) {
  const auto leaf = image_of(2, 1, {0xFF00C800U, 0x000000FFU});  // opaque green, transparent red
  EXPECT_EQ(channels(shrink(leaf, 1, 1, TexelKind::kColor).texels[0]), (std::array{0U, 200U, 0U, 128U}));
  const auto nothing = image_of(2, 1, {0x000000FFU, 0x000000FFU});
  EXPECT_EQ(channels(shrink(nothing, 1, 1, TexelKind::kColor).texels[0]), (std::array{255U, 0U, 0U, 0U}));
}

TEST(Shrink, NormalsAreOfLengthOneAgain) {
  // 45 degrees to either side of +z: their mean is shorter, and points along +z.
  const auto packed = [](double x, double y, double z) {
    const auto level = [](double v) { return static_cast<std::uint32_t>(std::lround((0.5 + 0.5 * v) * 255.0)); };
    return level(x) | level(y) << 8U | level(z) << 16U | 0xFF000000U;
  };
  const double h = std::sqrt(0.5);
  const auto ridge = image_of(2, 1, {packed(h, 0, h), packed(-h, 0, h)});
  const auto texel = channels(shrink(ridge, 1, 1, TexelKind::kNormal).texels[0]);
  EXPECT_NEAR(texel[0], 127.5, 1.0);
  EXPECT_EQ(texel[2], 255U);
  const auto opposite = image_of(2, 1, {packed(1, 0, 0), packed(-1, 0, 0)});
  EXPECT_EQ(channels(shrink(opposite, 1, 1, TexelKind::kNormal).texels[0])[2], 255U);
  std::mt19937 random(7);
  std::vector<std::uint32_t> texels(64 * 64);
  for (std::uint32_t& t : texels) t = static_cast<std::uint32_t>(random()) | 0xFF000000U;
  for (const std::uint32_t t : shrink(image_of(64, 64, texels), 13, 7, TexelKind::kNormal).texels) {
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) square += std::pow(2.0 * channels(t)[k] / 255.0 - 1.0, 2.0);
    EXPECT_NEAR(std::sqrt(square), 1.0, 0.01);
  }
}

TEST(Shrink, EachTexelIsTheMeanOfWhatItCovers) {
  // 3 to 2: the first covers one and a half. 0, 90, 240 become 30 and 190.
  const auto row = image_of(3, 1, {kBlack, kBlack | 0x5A5A5AU, kBlack | 0xF0F0F0U});
  const auto out = shrink(row, 2, 1, TexelKind::kData);
  EXPECT_EQ(channels(out.texels[0])[0], 30U);
  EXPECT_EQ(channels(out.texels[1])[0], 190U);
  // The mean of all stays, for any ratio.
  std::mt19937 random(1);
  std::vector<std::uint32_t> texels(97 * 61);
  double sum = 0.0;
  for (std::uint32_t& t : texels) {
    t = static_cast<std::uint32_t>(random()) | 0xFF000000U;
    sum += channels(t)[1];
  }
  const auto small = shrink(image_of(97, 61, texels), 31, 20, TexelKind::kData);
  double small_sum = 0.0;
  for (const std::uint32_t t : small.texels) small_sum += channels(t)[1];
  EXPECT_NEAR(small_sum / (31 * 20), sum / (97 * 61), 0.2);
}

TEST(Shrink, OneColourStaysForEveryLevel) {
  for (std::uint32_t level = 0; level < 256; ++level) {
    const std::uint32_t texel = level | level << 8U | level << 16U | 0xFF000000U;
    const auto flat = image_of(5, 3, std::vector<std::uint32_t>(15, texel));
    EXPECT_EQ(shrink(flat, 2, 1, TexelKind::kColor).texels[1], texel);
    EXPECT_EQ(shrink(flat, 2, 1, TexelKind::kData).texels[1], texel);
  }
}

TEST(GpuBytes, AreThoseOfAllMipLevels) {
  EXPECT_EQ(gpu_bytes_of({1, 1}), 4U);
  EXPECT_EQ(gpu_bytes_of({4, 4}), 4U * (16 + 4 + 1));
  EXPECT_EQ(gpu_bytes_of({5, 2}), 4U * (10 + 2 + 1));  // 5x2, 2x1, 1x1
  EXPECT_EQ(gpu_bytes_of({2048, 2048}), 22369620U);
}

}  // namespace
}  // namespace meshlode::app
