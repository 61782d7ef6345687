// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of files whose pixels are known.
#include "draw/textures/image.h"

#include <array>
#include <cstdlib>

#include <gtest/gtest.h>

#include "image_samples.h"

namespace meshlode::draw {
namespace {

using test::PngKind;

constexpr std::uint32_t kWidth = 37, kHeight = 11;  // rows of 1, 2 and 4 bits do not end with their byte

using Texel = std::array<std::uint8_t, 4>;

Texel texel(const DecodedImage& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* t = &image.rgba()[4 * (std::size_t{y} * image.width + x)];
  return {t[0], t[1], t[2], t[3]};
}

std::uint32_t sample(std::uint32_t x, std::uint32_t y, std::uint32_t channel, std::uint32_t bits) {
  return (x * 7 + y * 13 + channel * 29 + x * y) & ((1u << bits) - 1u);
}

std::vector<std::uint8_t> pack_rows(std::uint32_t channels, std::uint32_t bits) {
  std::vector<std::uint8_t> out;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    std::uint32_t filled = 0;
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      for (std::uint32_t c = 0; c < channels; ++c) {
        const std::uint32_t value = sample(x, y, c, bits);
        for (std::uint32_t b = bits; b-- > 0;) {
          if (filled % 8 == 0) out.push_back(0);
          out.back() = static_cast<std::uint8_t>(out.back() | (value >> b & 1u) << (7 - filled % 8));
          ++filled;
        }
      }
    }
  }
  return out;
}

/// 0 … 2^bits - 1 to the nearest of 0 … 255.
std::uint8_t scaled(std::uint32_t value, std::uint32_t bits) {
  const std::uint32_t most = (1u << bits) - 1u;
  return static_cast<std::uint8_t>((value * 255u * 2u + most) / (2u * most));
}

TEST(Png, EveryKindIsRead) {
  struct Case {
    PngKind kind;
    std::uint32_t channels;
  };
  std::vector<Case> cases;
  for (const bool is_interlaced : {false, true}) {
    for (const bool has_transparency : {false, true}) {
      for (const int bits : {1, 2, 4, 8, 16}) cases.push_back({{0, bits, is_interlaced, has_transparency}, 1});
      for (const int bits : {8, 16}) cases.push_back({{2, bits, is_interlaced, has_transparency}, 3});
      for (const int bits : {1, 2, 4, 8}) cases.push_back({{3, bits, is_interlaced, has_transparency}, 1});
    }
    for (const int bits : {8, 16}) cases.push_back({{4, bits, is_interlaced, false}, 2});
    for (const int bits : {8, 16}) cases.push_back({{6, bits, is_interlaced, false}, 4});
  }
  for (const auto& [kind, channels] : cases) {
    const auto bits = static_cast<std::uint32_t>(kind.bit_depth);
    SCOPED_TRACE("type " + std::to_string(kind.color_type) + ", " + std::to_string(bits) + " bits");
    const auto image = decode_image(test::make_png(kWidth, kHeight, kind, pack_rows(channels, bits)));
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(image->width, kWidth);
    ASSERT_EQ(image->height, kHeight);
    for (std::uint32_t y = 0; y < kHeight; ++y) {
      for (std::uint32_t x = 0; x < kWidth; ++x) {
        const auto value = [&](std::uint32_t c) { return scaled(sample(x, y, c, bits), bits); };
        Texel want{value(0), value(0), value(0), 255};
        if (channels >= 3) want = {value(0), value(1), value(2), 255};
        if (kind.color_type == 4) want[3] = value(1);
        if (kind.color_type == 6) want[3] = value(3);
        if (kind.color_type == 3) {
          const test::PaletteEntry e = test::palette_entry(sample(x, y, 0, bits));
          want = {e.r, e.g, e.b, kind.has_transparency ? e.a : std::uint8_t{255}};
        } else if (kind.has_transparency) {
          bool is_key = true;
          for (std::uint32_t c = 0; c < channels; ++c) is_key = is_key && sample(x, y, c, bits) == 0;
          want[3] = is_key ? 0 : 255;
        }
        ASSERT_EQ(texel(*image, x, y), want) << x << "," << y;
      }
    }
  }
}

TEST(Jpeg, GreyAndColourAreReadNearlyAsTheyWere) {
  for (const bool is_progressive : {false, true}) {
    for (const int components : {1, 3}) {
      std::vector<std::uint8_t> pixels;
      for (std::uint32_t y = 0; y < kHeight; ++y) {
        for (std::uint32_t x = 0; x < kWidth; ++x) {
          for (int c = 0; c < components; ++c) {
            pixels.push_back(static_cast<std::uint8_t>(40 + 4 * x + 3 * y + static_cast<std::uint32_t>(c) * 5));
          }
        }
      }
      const auto image = decode_image(test::make_jpeg(kWidth, kHeight, components, is_progressive, pixels));
      ASSERT_TRUE(image) << image.error().message();
      ASSERT_EQ(image->width, kWidth);
      ASSERT_EQ(image->height, kHeight);
      const auto channels = static_cast<std::size_t>(components);
      for (std::size_t i = 0; i < std::size_t{kWidth} * kHeight; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_LE(std::abs(int{image->rgba()[4 * i + c]} - int{pixels[channels * i + c % channels]}), 3) << i;
        }
        EXPECT_EQ(image->rgba()[4 * i + 3], 255);
      }
    }
  }
}

TEST(Webp, LosslessIsReadExactlyAndLossyNearly) {
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t y = 0; y < kHeight; ++y) {
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      for (std::uint32_t c = 0; c < 4; ++c) pixels.push_back(static_cast<std::uint8_t>(60 + 3 * x + 2 * y + 5 * c));
    }
  }
  for (const bool is_lossless : {true, false}) {
    const auto image = decode_image(test::make_webp(kWidth, kHeight, is_lossless, pixels));
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(image->width, kWidth);
    ASSERT_EQ(image->height, kHeight);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const int off = std::abs(int{image->rgba()[i]} - int{pixels[i]});
      ASSERT_LE(off, is_lossless || i % 4 == 3 ? 0 : 8) << i;  // alpha is lossless in both
    }
  }
}

TEST(Jpeg, FourColoursAreRefused) {
  const std::vector<std::uint8_t> pixels(4 * kWidth * kHeight, 100);
  const auto image = decode_image(test::make_jpeg(kWidth, kHeight, 4, false, pixels));
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace meshlode::draw
