// SPDX-License-Identifier: GPL-3.0-or-later
// Mip levels and trilinear samples against closed forms.
#include "draw/textures/texture_image.h"

#include <cmath>

#include <gtest/gtest.h>

namespace meshlode::draw {
namespace {

DecodedImage image_of(std::uint32_t width, std::uint32_t height, std::uint8_t (*value)(std::uint32_t, std::uint32_t)) {
  DecodedImage out{width, height, {}};
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::uint8_t v = value(x, y);
      out.texels.push_back(v | (255U - v) << 8U | std::uint32_t{v} << 24U);
    }
  }
  return out;
}

std::uint8_t hashed(std::uint32_t x, std::uint32_t y) {
  return static_cast<std::uint8_t>((x * 2654435761U ^ y * 40503U * 97U) >> 7);
}

std::uint32_t red(const TextureImage& image, std::uint32_t level, std::uint32_t x, std::uint32_t y) {
  return image.texels[image.first[level] + y * image.width_of(level) + x] & 255u;
}

TEST(TextureImage, LevelsHalveDownToOneTexelAndKeepTheMean) {
  for (const auto& [width, height] :
       {std::pair(16U, 16U), std::pair(37U, 11U), std::pair(1U, 9U), std::pair(64U, 1U)}) {
    const TextureImage image = make_texture_image(image_of(width, height, hashed), false);
    std::size_t texels = 0;
    for (std::uint32_t level = 0; level < image.level_count(); ++level) {
      EXPECT_EQ(image.first[level], texels);
      EXPECT_EQ(image.width_of(level), std::max(1U, width >> level));
      EXPECT_EQ(image.height_of(level), std::max(1U, height >> level));
      texels += std::size_t{image.width_of(level)} * image.height_of(level);
      double mean = 0.0, whole = 0.0;
      for (std::uint32_t y = 0; y < image.height_of(level); ++y) {
        for (std::uint32_t x = 0; x < image.width_of(level); ++x) mean += red(image, level, x, y);
      }
      for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) whole += hashed(x, y);
      }
      mean /= static_cast<double>(image.width_of(level)) * image.height_of(level);
      EXPECT_NEAR(mean, whole / (width * height), 0.5 * level + 1e-9) << "rounded to 8 bits at each level";
    }
    EXPECT_EQ(image.texels.size(), texels);
    EXPECT_EQ(image.width_of(image.level_count() - 1) * image.height_of(image.level_count() - 1), 1U);
  }
}

/// Half black, half white is half the light: 188 in sRGB, 128 of linear data; alpha is never sRGB.
TEST(TextureImage, LightIsAveragedNotItsCode) {
  const auto checker = [](std::uint32_t x, std::uint32_t y) { return static_cast<std::uint8_t>((x + y) % 2 * 255); };
  const TextureImage srgb = make_texture_image(image_of(8, 8, checker), true);
  const TextureImage data = make_texture_image(image_of(8, 8, checker), false);
  for (std::uint32_t level = 1; level < 4; ++level) {
    EXPECT_EQ(red(srgb, level, 0, 0), 188U);
    EXPECT_EQ(srgb.texels[srgb.first[level]] >> 24, 128U);
    EXPECT_EQ(red(data, level, 0, 0), 128U);
  }
}

TEST(TextureImage, SamplesAreLinearBetweenTexels) {
  const auto ramp = [](std::uint32_t x, std::uint32_t y) { return static_cast<std::uint8_t>(8 * x + 40 * y); };
  const TextureImage image = make_texture_image(image_of(16, 4, ramp), false);
  for (double x = 0.5; x <= 15.5; x += 0.37) {
    for (double y = 0.5; y <= 3.5; y += 0.41) {
      const auto c = sample_texture(image, Wrap::kRepeat, Wrap::kClamp, {{x / 16.0, y / 4.0}, {}, {}});
      EXPECT_NEAR(c[0] * 255.0, 8.0 * (x - 0.5) + 40.0 * (y - 0.5), 1e-3);
      EXPECT_NEAR(c[1] * 255.0, 255.0 - 8.0 * (x - 0.5) - 40.0 * (y - 0.5), 1e-3);
    }
  }
  // Beyond the border: the first and the last texel, a mean across the seam, the row turned around.
  const auto at = [&](double u, Wrap wrap) {
    return 255.0 * sample_texture(image, wrap, Wrap::kClamp, {{u, 0.125}, {}, {}})[0];
  };
  EXPECT_NEAR(at(-3.0, Wrap::kClamp), 0.0, 1e-3);
  EXPECT_NEAR(at(7.0, Wrap::kClamp), 120.0, 1e-3);
  EXPECT_NEAR(at(2.0, Wrap::kRepeat), 60.0, 1e-3);
  EXPECT_NEAR(at(1.0 + 4.5 / 16.0, Wrap::kRepeat), 32.0, 1e-3);
  EXPECT_NEAR(at(1.0 + 4.5 / 16.0, Wrap::kMirror), 88.0, 1e-3);
  EXPECT_NEAR(at(-4.5 / 16.0, Wrap::kMirror), 32.0, 1e-3);
}

TEST(TextureImage, AFootprintOfTwoToTheNIsLevelN) {
  const TextureImage image = make_texture_image(image_of(64, 32, hashed), false);
  for (int n = 0; n <= 6; ++n) {
    const double texels = std::ldexp(1.0, n);
    EXPECT_NEAR(level_of_detail(image, {{}, {texels / 64.0, 0.0}, {0.0, 0.25 / 32.0}}), n, 1e-12);
    EXPECT_NEAR(level_of_detail(image, {{}, {0.0, 0.0}, {0.6 * texels / 64.0, 0.8 * texels / 32.0}}), n, 1e-12);
  }
  EXPECT_EQ(level_of_detail(image, {{}, {1e3, 0.0}, {0.0, 0.0}}), 6.0) << "the last level";
  EXPECT_EQ(level_of_detail(image, {{}, {1e-9, 0.0}, {0.0, 0.0}}), 0.0) << "the base level is the sharpest";
  EXPECT_EQ(level_of_detail(image, {{}, {std::nan(""), 0.0}, {0.0, 0.0}}), 0.0);
  EXPECT_EQ(level_of_detail(image, {{}, {1e300, 0.0}, {0.0, 0.0}}), 6.0);
}

TEST(TextureImage, AnyFootprintIsHarmless) {
  const TextureImage image = make_texture_image(image_of(5, 3, hashed), true);
  const double bad[] = {std::nan(""), 1e300, -1e300, HUGE_VAL, -HUGE_VAL, 1e15, -0.0};
  for (const double u : bad) {
    for (const double d : bad) {
      for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
        for (const double c : sample_texture(image, wrap, wrap, {{u, 0.3}, {d, 0.0}, {0.0, u}})) {
          EXPECT_GE(c, 0.0);
          EXPECT_LE(c, 1.0 + 1e-9);
        }
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::draw
