// SPDX-License-Identifier: GPL-3.0-or-later
// Budgets in texels: the size of a texture is read from its header, and found through material, texture and image.
#include "build/plan/texel_sizes.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "build/plan/image_size.h"

namespace meshlode::build {
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

scene::Scene scene_of(const std::string& materials) {
  scene::Scene scene;
  scene::SceneBlob small;
  small.bytes = png_of(0, 16, 8);
  scene::SceneBlob large;
  large.bytes = jpeg(0xC0);
  scene::SceneBlob unknown;
  unknown.bytes = {1, 2, 3};
  scene.blobs = {small, large, unknown};
  scene.document = R"({"images":[{"blob":0},{"blob":1},{"blob":2},{}],
    "textures":[{"source":0},{"source":1},{"source":2},{"source":3},{}], "materials":[)" +
                   materials + "]}";
  scene::SceneMaterial material;
  material.source_index = 0;
  scene.materials = {material};
  scene::SourceMesh mesh;
  mesh.primitives.emplace_back().material = MaterialId{0U};
  scene.meshes = {mesh};
  return scene;
}

std::array<double, scene::kMaxUvSets> texels_of(const std::string& materials) {
  const scene::Scene scene = scene_of(materials);
  return texels_per_unit(scene, scene.meshes[0]);
}

TEST(TexelSizes, TheLargestTextureOfASetCounts) {
  const auto texels = texels_of(
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"normalTexture":{"index":1},"emissiveTexture":{"index":0,"texCoord":1}})");
  EXPECT_EQ(texels[0], 513.0);
  EXPECT_EQ(texels[1], 16.0);
  EXPECT_EQ(texels[2], 0.0);
}

TEST(TexelSizes, ExtensionsAndTransformsCount) {
  EXPECT_EQ(texels_of(R"({"extensions":{"KHR_materials_sheen":{"sheenColorTexture":{"index":0,"texCoord":2}}}})")[2],
            16.0);
  const auto texels = texels_of(
      R"({"normalTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[4,-20],"texCoord":3}}}})");
  EXPECT_EQ(texels[3], 160.0) << "8 texels high, twenty times";
  EXPECT_EQ(texels[0], 0.0);
}

TEST(TexelSizes, WhatCannotBeKnownIsZero) {
  for (const char* materials :
       {"", "7", "{}", R"({"normalTexture":{"index":2}})", R"({"normalTexture":{"index":3}})",
        R"({"normalTexture":{"index":4}})", R"({"normalTexture":{"index":99}})", R"({"normalTexture":{"index":-1}})",
        R"({"normalTexture":{"index":0,"texCoord":9}})", R"({"normalTexture":{"index":0,"texCoord":"x"}})"}) {
    for (const double texels : texels_of(materials)) EXPECT_EQ(texels, 0.0) << materials;
  }
  scene::Scene scene = scene_of("{}");
  scene.document = "no JSON";
  EXPECT_EQ(texels_per_unit(scene, scene.meshes[0])[0], 0.0);
}

}  // namespace
}  // namespace meshlode::build
