// SPDX-License-Identifier: GPL-3.0-or-later
// Budgets in texels: the size of a texture is read from its header, for the images that import found.
#include "builder/plan/texel_sizes.h"

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/image_size.h"
#include "scene/import/import.h"

namespace meshlode::builder {
namespace {

std::vector<std::uint8_t> png_of(std::uint8_t width_high, std::uint8_t width_low, std::uint8_t height_low) {
  return {0x89, 'P', 'N', 'G',        0x0D,      0x0A, 0x1A, 0x0A, 0,          0, 0, 13, 'I', 'H', 'D',
          'R',  0,   0,   width_high, width_low, 0,    0,    0,    height_low, 8, 6, 0,  0,   0};
}

/// SOI, an APP0 segment of 16 bytes, a fill byte, then the frame header: 300 lines of 513 samples.
std::vector<std::uint8_t> jpeg(std::uint8_t frame_marker) {
  std::vector<std::uint8_t> bytes(20, 0);
  bytes[0] = bytes[2] = 0xFF;
  bytes[1] = 0xD8;
  bytes[3] = 0xE0;
  bytes[5] = 16;
  for (const int b : {0xFF, 0xFF, int{frame_marker}, 0, 17, 8, 1, 44, 2, 1, 3})
    bytes.push_back(static_cast<std::uint8_t>(b));
  return bytes;
}

std::vector<std::uint8_t> bytes_of(std::initializer_list<int> values) {
  std::vector<std::uint8_t> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

/// The identifier and the first four words of a KTX2's header.
std::vector<std::uint8_t> ktx2(int width_low, int width_high, int height_high) {
  return bytes_of({0xAB, 'K', 'T', 'X', ' ', '2', '0',       0xBB,       0x0D, 0x0A, 0x1A, 0x0A,        0, 0,
                   0,    0,   1,   0,   0,   0,   width_low, width_high, 0,    0,    0,    height_high, 0, 0});
}

/// A WebP whose first chunk is called VP8 and this, and begins with these ten bytes.
std::vector<std::uint8_t> webp(char kind, std::initializer_list<int> data) {
  auto bytes = bytes_of({'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', kind, 10, 0, 0, 0});
  for (const int value : data) bytes.push_back(static_cast<std::uint8_t>(value));
  return bytes;
}

/// 550 × 368 lossy, 386 × 395 lossless (of the specification's bits), 65,537 × 2 extended.
const std::vector<std::uint8_t> kLossy = webp(' ', {0x30, 1, 0, 0x9D, 0x01, 0x2A, 0x26, 0x42, 0x70, 0x81});
const std::vector<std::uint8_t> kLossless = webp('L', {0x2F, 0x81, 0x81, 0x62, 0x10, 0, 0, 0, 0, 0});
const std::vector<std::uint8_t> kExtended = webp('X', {0x10, 0, 0, 0, 0, 0, 1, 1, 0, 0});

TEST(ImageSize, ReadsKtx2AndTheThreeKindsOfWebp) {
  const auto expect = [](const std::vector<std::uint8_t>& bytes, std::uint32_t width, std::uint32_t height) {
    const auto size = read_image_size(bytes);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, width);
    EXPECT_EQ(size->height, height);
    for (std::size_t cut = 0; cut < bytes.size(); ++cut)
      EXPECT_FALSE(read_image_size(std::span(bytes).first(cut))) << cut;
  };
  expect(ktx2(2, 1, 3), 258, 768);
  expect(kLossy, 550, 368);
  expect(kLossless, 386, 395);
  expect(kExtended, 65537, 2);
  EXPECT_FALSE(read_image_size(ktx2(1, 0, 0))) << "one dimension";
  EXPECT_FALSE(read_image_size(webp(' ', {0x31, 1, 0, 0x9D, 0x01, 0x2A, 0x26, 2, 0x70, 1}))) << "no key frame";
  EXPECT_FALSE(read_image_size(webp(' ', {0x30, 1, 0, 0x9D, 0x01, 0x2B, 0x26, 2, 0x70, 1}))) << "no start code";
  EXPECT_FALSE(read_image_size(webp('L', {0x2E, 0x81, 0x81, 0x62, 0x10, 0, 0, 0, 0, 0}))) << "no signature";
  EXPECT_FALSE(read_image_size(webp('Y', {0x10, 0, 0, 0, 0, 0, 1, 1, 0, 0})));
}

TEST(ImageSize, ReadsPngAndJpeg) {
  const auto png = read_image_size(png_of(2, 0, 64));
  ASSERT_TRUE(png);
  EXPECT_EQ(png->width, 512U);
  EXPECT_EQ(png->height, 64U);
  for (const int marker : {0xC0, 0xC2, 0xCF}) {  // baseline, progressive, arithmetic
    const auto size = read_image_size(jpeg(static_cast<std::uint8_t>(marker)));
    ASSERT_TRUE(size);
    EXPECT_EQ(size->width, 513U);
    EXPECT_EQ(size->height, 300U);
  }
}

TEST(ImageSize, RefusesWhatIsNeitherOrEndsEarly) {
  EXPECT_FALSE(read_image_size({}));
  EXPECT_FALSE(read_image_size(png_of(0, 0, 64))) << "no width";
  EXPECT_FALSE(read_image_size(jpeg(0xC4))) << "a table, and no frame";
  for (const auto& whole : {png_of(2, 0, 64), jpeg(0xC0)}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const bool has_all =
          whole[0] == 0x89 ? size >= 24 : size >= whole.size() - 1;  // the JPEG's last byte is not needed
      EXPECT_EQ(read_image_size(std::span(whole).first(size)).has_value(), has_all) << size;
    }
  }
  // A segment that claims no length, and one that leaps beyond the end.
  EXPECT_FALSE(read_image_size(std::vector<std::uint8_t>{0xFF, 0xD8, 0xFF, 0xE0, 0, 0, 0xFF, 0xC0}));
  EXPECT_FALSE(read_image_size(std::vector<std::uint8_t>{0xFF, 0xD8, 0xFF, 0xE0, 0xFF, 0xFF, 0xFF, 0xC0}));
}

scene::TextureUse use_of(std::uint32_t blob, std::uint32_t uv_set = 0, std::array<double, 2> scale = {1.0, 1.0}) {
  scene::TextureUse use;
  use.blob = blob;
  use.uv_set = uv_set;
  use.scale = scale;
  return use;
}

/// Blobs: a PNG of 16 × 8 texels, a JPEG of 513 × 300, one of no kind, a KTX2 of 1024 × 512.
std::array<double, scene::kMaxUvSets> texels_of(std::vector<scene::TextureUse> uses) {
  scene::Scene scene;
  for (const auto& bytes : {png_of(0, 16, 8), jpeg(0xC0), {1, 2, 3}, ktx2(0, 4, 2)})
    scene.blobs.emplace_back().bytes = bytes;
  scene.document = "no JSON";
  scene.materials.emplace_back().textures = std::move(uses);
  scene.meshes.emplace_back().primitives.emplace_back().material = MaterialId{0U};
  return texels_per_unit(scene, scene.meshes[0]);
}

TEST(TexelSizes, TheLargestTextureOfASetCounts) {
  const auto texels = texels_of({use_of(0), use_of(1), use_of(0, 1)});
  EXPECT_EQ(texels[0], 513.0);
  EXPECT_EQ(texels[1], 16.0);
  EXPECT_EQ(texels[2], 0.0);
  EXPECT_EQ(texels_of({use_of(0), use_of(3)})[0], 1024.0) << "of any kind that is known";
}

TEST(TexelSizes, TransformsCount) {
  const auto texels = texels_of({use_of(0, 3, {4.0, -20.0})});
  EXPECT_EQ(texels[3], 160.0) << "8 texels high, twenty times";
  EXPECT_EQ(texels[0], 0.0);
}

TEST(TexelSizes, WhatCannotBeKnownIsZero) {
  const double infinite = std::numeric_limits<double>::infinity();
  for (const scene::TextureUse& use : {scene::TextureUse(), use_of(2), use_of(4), use_of(0xFFFFFFFFu), use_of(0, 4),
                                       use_of(0, 0xFFFFFFFFu), use_of(0, 0, {infinite, 1.0})}) {
    for (const double texels : texels_of({use})) EXPECT_EQ(texels, 0.0) << use.blob << " " << use.uv_set;
  }
  for (const double texels : texels_of({})) EXPECT_EQ(texels, 0.0);
}

/// The recorded uses of a real import, down to the texels.
TEST(TexelSizes, AnImageNamedByAnExtensionCounts) {
  std::string bytes;
  for (const std::uint8_t byte : ktx2(0, 16, 2)) bytes += static_cast<char>(byte);
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "texel_sizes";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.ktx2", std::ios::binary) << bytes;
  std::ofstream(folder / "a.gltf") << R"({"asset":{"version":"2.0"},
    "accessors":[{"componentType":5126,"count":3,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
    "materials":[{"normalTexture":{"index":0}}],"images":[{"uri":"a.ktx2"}],
    "textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}]})";
  const auto scene = scene::import_scene(folder / "a.gltf", {});
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(texels_of_materials(*scene).at(0)[0], 4096.0);
}

}  // namespace
}  // namespace meshlode::builder
