// SPDX-License-Identifier: GPL-3.0-or-later
// Texture references of the scene's document, KHR_texture_transform among them.
#include <cmath>

#include <gtest/gtest.h>

#include "draw/textures/texture_use.h"
#include "support/mask_scene.h"

namespace meshlode::draw {
namespace {

/// Of card 0, material 1 of the source.
MaterialTextures textures_with(const std::string& document_materials, const std::string& rest) {
  scene::Scene scene = test::mask_scene({});
  scene.document = R"({"asset":{"version":"2.0"},"materials":[{},)" + document_materials + "]" + rest + "}";
  const auto asset = run::Asset::from_vector(test::built(scene));
  EXPECT_TRUE(asset);
  const auto all = read_material_textures(*asset);
  EXPECT_EQ(all.size(), asset->materials().size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (asset->materials()[i].source_index == 1) return all[i];
  }
  ADD_FAILURE() << "no material 1";
  return {};
}

const std::string kTables = R"(,"textures":[{"source":0}],"images":[{"blob":0}])";

std::string base_color(const std::string& info) {
  return R"({"pbrMetallicRoughness":{"baseColorTexture":)" + info + "}}";
}

TEST(TextureUse, ATransformMovesAsTheExtensionsExamplesSay) {
  // "only the lower left quadrant of the source image": u in 0 … 0.5, v in 0.5 … 1 (v points down).
  const auto quadrant = textures_with(
      base_color(
          R"({"index":0,"extensions":{"KHR_texture_transform":{"offset":[0,1],"rotation":1.57079632679,"scale":[0.5,0.5]}}})"),
      kTables);
  ASSERT_TRUE(quadrant.base_color);
  const auto at = [&](double u, double v) {
    const auto& [a, b] = std::pair(quadrant.base_color->row_u, quadrant.base_color->row_v);
    return std::pair(a[0] * u + a[1] * v + a[2], b[0] * u + b[1] * v + b[2]);
  };
  for (const double u : {0.0, 1.0}) {
    for (const double v : {0.0, 1.0}) {
      EXPECT_GE(at(u, v).first, -1e-9);
      EXPECT_LE(at(u, v).first, 0.5 + 1e-9);
      EXPECT_GE(at(u, v).second, 0.5 - 1e-9);
      EXPECT_LE(at(u, v).second, 1.0 + 1e-9);
    }
  }
  // "inverts the T axis".
  const auto inverted = textures_with(
      base_color(R"({"index":0,"extensions":{"KHR_texture_transform":{"offset":[0,1],"scale":[1,-1]}}})"), kTables);
  ASSERT_TRUE(inverted.base_color);
  EXPECT_EQ(inverted.base_color->row_u, (std::array{1.0, 0.0, 0.0}));
  EXPECT_EQ(inverted.base_color->row_v, (std::array{0.0, -1.0, 1.0}));
}

TEST(TextureUse, SetsAndTexturesAreThoseOfTheReference) {
  const auto other = textures_with(
      R"({"normalTexture":{"index":0,"scale":0.25,"texCoord":1},)"
      R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":2,"extensions":{"KHR_texture_transform":{"texCoord":3}}}}})",
      kTables);
  ASSERT_TRUE(other.base_color);
  EXPECT_EQ(other.base_color->uv_set, 3u) << "the transform's set goes before";
  EXPECT_EQ(other.base_color->blob, 0u);
  ASSERT_TRUE(other.normal);
  EXPECT_EQ(other.normal->uv_set, 1u);
  EXPECT_EQ(other.normal_scale, 0.25);
  const auto glossy = textures_with(
      R"({"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}}})", kTables);
  EXPECT_TRUE(glossy.base_color);
  const auto bare = textures_with(
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"extensions":{"KHR_materials_pbrSpecularGlossiness":{}}})",
      kTables);
  EXPECT_FALSE(bare.base_color) << "specular-glossiness stands in the place of metallic-roughness";
}

TEST(TextureUse, AnImageThatAnExtensionNamesIsFound) {
  const auto blob_of = [](const std::string& texture) {
    const auto use = textures_with(base_color(R"({"index":0})"),
                                   R"(,"textures":[)" + texture + R"(],"images":[{},{"blob":0},{"blob":9}])");
    EXPECT_TRUE(use.base_color) << texture;
    return use.base_color ? use.base_color->blob : 7;
  };
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
    const std::string extensions = R"("extensions":{")" + std::string(name) + R"(":{"source":1}})";
    EXPECT_EQ(blob_of("{" + extensions + "}"), 0u) << name;
    EXPECT_EQ(blob_of(R"({"source":0,)" + extensions + "}"), format::kNone) << "the texture's own source goes first";
  }
  EXPECT_EQ(blob_of(R"({"extensions":{"MSFT_texture_dds":{"source":1},"EXT_texture_webp":{"source":0}}})"),
            format::kNone)
      << "in the order of the rule, not of the document";
  for (const char* nonsense :
       {R"({"extensions":{"KHR_texture_basisu":{"source":3}}})",
        R"({"extensions":{"KHR_texture_basisu":{"source":2}}})",
        R"({"extensions":{"KHR_texture_basisu":{"source":-1}}})", R"({"extensions":{"KHR_texture_basisu":1}})",
        R"({"extensions":[{"source":1}]})", R"({"extensions":{"ACME_texture":{"source":1}}})"}) {
    EXPECT_EQ(blob_of(nonsense), format::kNone) << nonsense;
  }
}

TEST(TextureUse, WholeNumbersWithAPointAreIndicesAsTheyAreForTheImporter) {
  const char* tables = R"(,"textures":[{"source":1.0}],"images":[{},{"blob":0}])";
  const auto use = textures_with(base_color(R"({"index":0.0})"), tables);
  ASSERT_TRUE(use.base_color);
  EXPECT_EQ(use.base_color->blob, 0U);
  for (const char* index : {"0.5", "-1.0", "1e300"}) {
    const std::string info = R"({"index":)" + std::string(index) + "}";
    EXPECT_FALSE(textures_with(base_color(info), tables).base_color) << index;
  }
}

TEST(TextureUse, NonsenseCountsAsNotThere) {
  EXPECT_FALSE(textures_with(base_color(R"({"index":7})"), kTables).base_color);
  EXPECT_FALSE(textures_with(base_color(R"({"index":-1})"), kTables).base_color);
  EXPECT_FALSE(textures_with(base_color("3"), kTables).base_color);
  EXPECT_FALSE(textures_with("[]", kTables).base_color);
  EXPECT_FALSE(textures_with(base_color(R"({"index":0})"), R"(,"textures":{})").base_color);
  const auto no_image =
      textures_with(base_color(R"({"index":0})"), R"(,"textures":[{"source":1}],"images":[{"blob":0}])");
  ASSERT_TRUE(no_image.base_color);
  EXPECT_EQ(no_image.base_color->blob, format::kNone);
  for (const char* transform :
       {R"({"scale":[1e300,1]})", R"({"offset":[1e10,0]})", R"({"rotation":"x","scale":[1],"offset":{}})", "[]"}) {
    const auto use = textures_with(
        base_color(R"({"index":0,"extensions":{"KHR_texture_transform":)" + std::string(transform) + "}}"), kTables);
    ASSERT_TRUE(use.base_color) << transform;
    EXPECT_EQ(use.base_color->row_u, (std::array{1.0, 0.0, 0.0})) << transform;
    EXPECT_EQ(use.base_color->row_v, (std::array{0.0, 1.0, 0.0})) << transform;
  }
}

}  // namespace
}  // namespace meshlode::draw
