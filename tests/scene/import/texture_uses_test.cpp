// SPDX-License-Identifier: GPL-3.0-or-later
// What import records beside each material: which image each of its textures is, and with which coordinates.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

using scene::TextureRole;
using scene::TextureUse;

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

/// Four images; the second has no bytes, so that there are three blobs.
const std::string kImages =
    R"("images":[{"uri":"data:image/png;base64,iVBORw=="},{"mimeType":"image/ktx2"},{"uri":"data:image/png;base64,iVBORw=="},)"
    R"({"uri":"data:image/webp;base64,UklGRg=="}])";

Result<scene::Scene> scene_of(const std::string& materials, const std::string& textures) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  return b.import(mesh_text("\"POSITION\":0", ",\"material\":0") + "," + kImages + ",\"textures\":[" + textures +
                  "],\"materials\":[" + materials + "]");
}

std::vector<TextureUse> uses_of(const std::string& material, const std::string& textures = R"({"source":0})") {
  const auto scene = scene_of(material, textures);
  EXPECT_TRUE(scene) << describe(scene);
  return scene ? scene->materials.at(0).textures : std::vector<TextureUse>();
}

/// The one use of a normal map by this texture.
TextureUse use_of_texture(const std::string& texture) {
  const auto uses = uses_of(R"({"normalTexture":{"index":0}})", texture);
  EXPECT_EQ(uses.size(), 1U);
  return uses.empty() ? TextureUse() : uses[0];
}

TEST(ImportTextureUses, AnImageIsTheTexturesOwnSourceElseTheFirstExtensions) {
  for (const char* extension : {"KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"}) {
    const std::string named = R"("extensions":{")" + std::string(extension) + R"(":{"source":3}})";
    EXPECT_EQ(use_of_texture("{" + named + "}").image, 3U) << extension;
    EXPECT_EQ(use_of_texture("{" + named + "}").blob, 2U) << extension;
    EXPECT_EQ(use_of_texture(R"({"source":0,)" + named + "}").image, 0U)
        << extension << ": the texture's own goes first";
  }
  const auto both = [](const char* first, const char* second) {
    return use_of_texture(R"({"extensions":{")" + std::string(first) + R"(":{"source":3},")" + second +
                          R"(":{"source":0}}})")
        .image;
  };
  // However the document orders them.
  EXPECT_EQ(both("KHR_texture_basisu", "EXT_texture_webp"), 3U);
  EXPECT_EQ(both("EXT_texture_webp", "KHR_texture_basisu"), 0U);
  EXPECT_EQ(both("EXT_texture_webp", "EXT_texture_avif"), 3U);
  EXPECT_EQ(both("MSFT_texture_dds", "EXT_texture_avif"), 0U);
  EXPECT_EQ(use_of_texture(R"({"extensions":{"KHR_texture_basisu":{},"MSFT_texture_dds":{"source":3}}})").image, 3U)
      << "an extension that names nothing is passed over";
  EXPECT_EQ(use_of_texture(R"({"extensions":{"ACME_texture_x":{"source":3}}})").image, kNone);
  EXPECT_EQ(use_of_texture("{}").image, kNone);
}

TEST(ImportTextureUses, TheBytesOfAnImageAreABlob) {
  EXPECT_EQ(use_of_texture(R"({"source":0})").blob, 0U);
  const TextureUse empty = use_of_texture(R"({"source":1})");
  EXPECT_EQ(empty.image, 1U);
  EXPECT_EQ(empty.blob, kNone) << "the image names no bytes";
  EXPECT_EQ(use_of_texture("{}").blob, kNone);
  const auto scene = scene_of(R"({"normalTexture":{"index":0}})", R"({"source":3})");
  ASSERT_TRUE(scene) << describe(scene);
  const TextureUse& use = scene->materials[0].textures.at(0);
  ASSERT_LT(use.blob, scene->blobs.size());
  EXPECT_EQ(scene->blobs[use.blob].mime_type, "image/webp");
}

TEST(ImportTextureUses, EachHasItsRole) {
  const auto uses =
      uses_of(R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}},)"
              R"("normalTexture":{"index":0},"occlusionTexture":{"index":0},"emissiveTexture":{"index":0},)"
              R"("extensions":{"KHR_materials_clearcoat":{"clearcoatNormalTexture":{"index":0}}}})");
  std::vector<TextureRole> roles;
  for (const TextureUse& use : uses) roles.push_back(use.role);
  EXPECT_EQ(roles, (std::vector{TextureRole::kBaseColor, TextureRole::kMetallicRoughness, TextureRole::kNormal,
                                TextureRole::kOcclusion, TextureRole::kEmissive, TextureRole::kOther}));
  const auto glossy = uses_of(
      R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}},"extensions":)"
      R"({"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0,"texCoord":2}}}})");
  ASSERT_EQ(glossy.size(), 3U);
  for (const TextureUse& use : glossy) {
    EXPECT_EQ(use.role, use.uv_set == 2 ? TextureRole::kBaseColor : TextureRole::kOther);
  }
}

TEST(ImportTextureUses, ATransformGoesAlongAndMayNameAnotherSet) {
  const auto uses =
      uses_of(R"({"normalTexture":{"index":0,"texCoord":1},"emissiveTexture":{"index":0,"texCoord":1,"extensions":)"
              R"({"KHR_texture_transform":{"texCoord":3,"offset":[0.5,-1],"rotation":0.25,"scale":[4,-20]}}}})");
  ASSERT_EQ(uses.size(), 2U);
  EXPECT_EQ(uses[0].uv_set, 1U);
  EXPECT_EQ(uses[0].scale, (std::array{1.0, 1.0}));
  EXPECT_EQ(uses[1].uv_set, 3U);
  EXPECT_EQ(uses[1].offset, (std::array{0.5, -1.0}));
  EXPECT_EQ(uses[1].scale, (std::array{4.0, -20.0}));
  EXPECT_EQ(uses[1].rotation, 0.25);
}

TEST(ImportTextureUses, ExtensionsCountWhoeverMadeThemExtrasDoNot) {
  const auto uses =
      uses_of(R"({"extensions":{"KHR_materials_sheen":{"sheenColorTexture":{"index":1,"texCoord":2}},)"
              R"("ACME_glitter":{"layers":[{"glitterTexture":{"index":0,"texCoord":9}},{"mask":{"index":0}}]}},)"
              R"("extras":{"oldTexture":{"index":0}}})",
              R"({"source":0},{"source":3})");
  ASSERT_EQ(uses.size(), 2U);
  EXPECT_EQ(uses[0].texture, 1U);
  EXPECT_EQ(uses[0].image, 3U);
  EXPECT_EQ(uses[0].uv_set, 2U);
  EXPECT_EQ(uses[1].texture, 0U);
  EXPECT_EQ(uses[1].uv_set, 9U) << "which is not kept, but is sampled";
}

// What nobody knows is not checked: it may hold anything.
TEST(ImportTextureUses, NonsenseInUnknownExtensionsNamesNothing) {
  for (const char* info : {R"({"index":1})", R"({"index":-1})", R"({"index":"0"})", R"({"index":0.5})",
                           R"({"index":4294967295})", R"({"index":1e300})", R"({"index":null})", R"({"index":[0]})"}) {
    const auto uses = uses_of(R"({"extensions":{"ACME_x":{"aTexture":)" + std::string(info) + "}}}");
    ASSERT_EQ(uses.size(), 1U) << info;
    EXPECT_EQ(uses[0].texture, kNone) << info;
    EXPECT_EQ(uses[0].image, kNone) << info;
    EXPECT_EQ(uses[0].blob, kNone) << info;
  }
  for (const char* nothing : {"3", "[]", "[{\"index\":0}]", "{}", "null", "\"index\""}) {
    EXPECT_TRUE(uses_of(R"({"extensions":{"ACME_x":{"aTexture":)" + std::string(nothing) + "}}}").empty()) << nothing;
  }
  for (const char* odd :
       {R"("texCoord":"x")", R"("texCoord":-1)", R"("extensions":3)", R"("extensions":{"KHR_texture_transform":[]})",
        R"("extensions":{"KHR_texture_transform":{"texCoord":{},"scale":[2],"offset":"x","rotation":[]}})",
        R"("extensions":{"KHR_texture_transform":{"scale":[2,null],"offset":[1,2,3]}})"}) {
    const auto uses = uses_of(R"({"extensions":{"ACME_x":{"aTexture":{"index":0,)" + std::string(odd) + "}}}}");
    ASSERT_EQ(uses.size(), 1U) << odd;
    EXPECT_EQ(uses[0].uv_set, 0U) << odd;
    EXPECT_EQ(uses[0].scale, (std::array{1.0, 1.0})) << odd;
    EXPECT_EQ(uses[0].offset, (std::array{0.0, 0.0})) << odd;
    EXPECT_EQ(uses[0].rotation, 0.0) << odd;
  }
  const auto far = uses_of(R"({"extensions":{"ACME_x":{"aTexture":{"index":0,"texCoord":9007199254740992}}}})");
  ASSERT_EQ(far.size(), 1U);
  EXPECT_EQ(far[0].uv_set, kNone);
}

TEST(ImportTextureUses, ImagesThatDoNotExistAreRefused) {
  for (const char* texture :
       {R"({"source":4})", R"({"source":-1})", R"({"source":"0"})", R"({"extensions":[]})",
        R"({"extensions":{"KHR_texture_basisu":{"source":4}}})",
        R"({"extensions":{"EXT_texture_webp":{"source":"0"}}})", R"({"extensions":{"EXT_texture_avif":3}})",
        R"({"source":0,"extensions":{"MSFT_texture_dds":{"source":1.5}}})"}) {
    const auto scene = scene_of(R"({"normalTexture":{"index":0}})", texture);
    ASSERT_FALSE(scene) << texture;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid) << texture;
    EXPECT_NE(scene.error().message().find("/textures/0"), std::string::npos) << scene.error().message();
  }
}

// One texture that many references name is looked into once, and a deep tree is as deep as the parser allows.
TEST(ImportTextureUses, ManyReferencesToATextureOfManyExtensionsTakeLinearTime) {
  std::string names;
  std::string references;
  for (int i = 0; i < 50000; ++i) {
    if (i > 0) {
      names += ",";
      references += ",";
    }
    names += "\"ACME_" + std::to_string(i) + "\":{}";
    references += R"({"aTexture":{"index":0}})";
  }
  const auto uses = uses_of(R"({"extensions":{"ACME_x":{"a":[)" + references + "]}}}",
                            R"({"extensions":{)" + names + R"(,"EXT_texture_webp":{"source":3}}})");
  ASSERT_EQ(uses.size(), 50000U);
  EXPECT_TRUE(std::all_of(uses.begin(), uses.end(), [](const TextureUse& use) { return use.image == 3; }));
}

}  // namespace
}  // namespace meshlode::testing
