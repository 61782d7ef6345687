// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes: an error or an image, in bounded time and memory (I11).
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "draw/textures/image.h"
#include "image_samples.h"

namespace meshlode::draw {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes noise(std::size_t count) {
  Bytes out;
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < count; ++i) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    out.push_back(static_cast<std::uint8_t>(state >> 56));
  }
  return out;
}

std::vector<Bytes> samples() {
  return {test::make_png(19, 17, {6, 8, false, false}, noise(19 * 17 * 4)),
          test::make_png(19, 17, {3, 4, true, true}, noise(10 * 17)),
          test::make_png(19, 17, {2, 16, true, false}, noise(19 * 17 * 6)),
          test::make_jpeg(19, 17, 3, false, noise(19 * 17 * 3)),
          test::make_jpeg(19, 17, 3, true, noise(19 * 17 * 3)),
          test::make_jpeg(19, 17, 1, false, noise(19 * 17)),
          test::make_webp(19, 17, true, noise(19 * 17 * 4)),
          test::make_webp(19, 17, false, noise(19 * 17 * 4))};
}

/// Reads, and looks at what came out.
void expect_harmless(const Bytes& bytes) {
  const auto image = decode_image(bytes);
  if (!image) {
    EXPECT_FALSE(image.error().detail.empty());
    return;
  }
  EXPECT_EQ(image->rgba().size(), std::size_t{4} * image->width * image->height);
  EXPECT_LE(image->width, kMaxTextureSide);
  EXPECT_LE(image->height, kMaxTextureSide);
}

TEST(Image, TruncationsAreErrorsOrHarmless) {
  for (const Bytes& whole : samples()) {
    for (std::size_t count = 0; count < whole.size(); ++count) {
      const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(count));
      expect_harmless(part);
      if (count < whole.size() / 2) {
        EXPECT_FALSE(decode_image(part)) << count << " of " << whole.size();
      }
    }
  }
}

TEST(Image, ChangedBytesAreHarmless) {
  for (const Bytes& whole : samples()) {
    std::uint64_t state = 7;
    for (int i = 0; i < 3000; ++i) {
      Bytes bytes = whole;
      for (int changes = 0; changes < 1 + i % 3; ++changes) {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        bytes[(state >> 33) % bytes.size()] = static_cast<std::uint8_t>(state >> 20);
      }
      expect_harmless(bytes);
    }
  }
}

/// The sides that a header states are believed only as far as the file's length can bear them out.
TEST(Image, AShortFileGetsNoLargeImage) {
  Bytes png = test::make_png(19, 17, {6, 8, false, false}, noise(19 * 17 * 4));
  const auto put = [&](std::size_t at, std::uint32_t value) {
    for (std::size_t k = 0; k < 4; ++k) png[at + k] = static_cast<std::uint8_t>(value >> (24 - 8 * k));
  };
  const auto seal = [&] {  // CRC of IHDR
    std::uint32_t crc = 0xFFFFFFFFu;
    for (std::size_t i = 12; i < 29; ++i) {
      crc ^= png[i];
      for (int b = 0; b < 8; ++b) crc = crc >> 1 ^ (0xEDB88320u & (0u - (crc & 1u)));
    }
    put(29, ~crc);
  };
  put(16, 16384);
  put(20, 16384);
  seal();
  const auto bomb = decode_image(png);
  ASSERT_FALSE(bomb);
  EXPECT_EQ(bomb.error().code, ErrorCode::kInvalid);
  put(16, 16385);
  seal();
  const auto wide = decode_image(png);
  ASSERT_FALSE(wide);
  EXPECT_EQ(wide.error().code, ErrorCode::kUnsupported);

  Bytes jpeg = test::make_jpeg(19, 17, 3, true, noise(19 * 17 * 3));
  for (std::size_t i = 0; i + 9 < jpeg.size(); ++i) {
    if (jpeg[i] != 0xFF || jpeg[i + 1] != 0xC2) continue;  // SOF2: height and width from the fifth byte on
    for (std::size_t k = 5; k < 9; k += 2) jpeg[i + k] = 0x3F;
    break;
  }
  const auto large = decode_image(jpeg);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kInvalid);
}

TEST(Image, OtherFormatsAreRefused) {
  for (const Bytes& bytes :
       {Bytes{}, Bytes{0x89}, Bytes{'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'A', 'V', 'E'}, Bytes(64, 0)}) {
    const auto image = decode_image(bytes);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, ErrorCode::kUnsupported);
  }
}

TEST(Image, WhatGltfCarriesAndNobodyDecodesIsNamed) {
  const std::pair<Bytes, std::string> kinds[] = {
      {{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 0x0D, 0x0A, 0x1A, 0x0A}, "KTX2"},
      {{'D', 'D', 'S', ' ', 124, 0, 0, 0}, "DDS"},
      {{0, 0, 0, 28, 'f', 't', 'y', 'p', 'a', 'v', 'i', 'f'}, "AVIF"},
      {{'G', 'I', 'F', '8', '9', 'a'}, "neither PNG, JPEG nor WebP"}};
  for (const auto& [bytes, name] : kinds) {
    const auto image = read_image_header(bytes);
    ASSERT_FALSE(image);
    EXPECT_EQ(image.error().code, ErrorCode::kUnsupported);
    EXPECT_NE(image.error().detail.find(name), std::string::npos) << image.error().detail;
  }
}

// One colour costs a WebP nothing, so that it could claim any size.
TEST(Image, AWebpOfAFewBytesGetsNoHugeImage) {
  Bytes webp = test::make_webp(16, 16, true, Bytes(16 * 16 * 4, 255));
  ASSERT_GT(webp.size(), 25u);
  ASSERT_EQ(webp[20], 0x2F);  // VP8L: 14 bits of width - 1 and of height - 1 follow
  for (const std::size_t at : {21u, 22u, 23u, 24u})
    webp[at] = static_cast<std::uint8_t>(webp[at] | (at == 24 ? 0x0F : 0xFF));
  const auto large = decode_image(webp);
  ASSERT_FALSE(large);
  EXPECT_NE(large.error().detail.find("too short"), std::string::npos) << large.error().detail;
  webp.resize(16);
  const auto cut = decode_image(webp);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().code, ErrorCode::kInvalid);
}

}  // namespace
}  // namespace meshlode::draw
