// SPDX-License-Identifier: GPL-3.0-or-later
// META and SCNE come from a file: whatever they hold, statistics are still had.
#include "app/report/read_meta.h"

#include <string>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

TEST(Meta, ReadsWhatThePipelineWrites) {
  const MetaInfo meta = read_meta(
      R"({"generator":"meshlode 0.1.0","source":{"file":"a.glb","hash":"00ff"},"settings":{"cluster_triangles":64},)"
      R"("plan":[{"what":"uv","kept":false,"reason":"no texture"}],"left_out":[{"what":"skin 0","why":"later"}]})");
  EXPECT_TRUE(meta.is_valid);
  EXPECT_EQ(meta.source_file, "a.glb");
  EXPECT_EQ(meta.source_hash, "00ff");
  EXPECT_EQ(meta.settings, R"({"cluster_triangles":64})");
  EXPECT_EQ(meta.cluster_triangles, 64U);
  ASSERT_EQ(meta.decisions.size(), 1U);
  EXPECT_EQ(meta.decisions[0].reason, "no texture");
  EXPECT_FALSE(meta.decisions[0].is_kept);
  ASSERT_EQ(meta.left_outs.size(), 1U);
  EXPECT_EQ(meta.left_outs[0].what, "skin 0");
}

TEST(Meta, AnswersEmptyForWhatIsNoMeta) {
  for (const char* text :
       {"", "[]", "{", "null", "\"a\"", "{\"source\":[1],\"settings\":3,\"plan\":{},\"left_out\":\"x\"}"}) {
    const MetaInfo meta = read_meta(text);
    EXPECT_EQ(meta.settings, "{}") << text;
    EXPECT_EQ(meta.plan, "[]") << text;
    EXPECT_EQ(meta.left_out, "[]") << text;
    EXPECT_EQ(meta.source_file, "") << text;
  }
  const MetaInfo odd = read_meta(R"({"plan":[1,null,{"what":7}],"left_out":[[]]})");
  EXPECT_EQ(odd.decisions.size(), 3U);
  EXPECT_EQ(odd.left_outs.size(), 1U);
}

// Dumping deep JSON recurses: a megabyte of brackets would overflow the stack.
TEST(Meta, RefusesDeepNesting) {
  const std::string deep = "{\"settings\":{\"a\":" + std::string(1U << 20, '[') + std::string(1U << 20, ']') + "}}";
  EXPECT_FALSE(read_meta(deep).is_valid);
  const std::string brackets_in_text = "{\"source\":{\"file\":\"" + std::string(1000, '[') + "\"}}";
  EXPECT_EQ(read_meta(brackets_in_text).source_file, std::string(1000, '['));
}

TEST(Meta, SaysWhatMeshesArePartsOf) {
  const auto origins = [](const char* parts) {
    return origins_of_meshes(read_meta(std::string(R"({"parts":)") + parts + "}"), 4);
  };
  using Origins = std::vector<std::size_t>;
  EXPECT_EQ(origins(R"([{"mesh":2,"of":0},{"mesh":3,"of":1}])"), (Origins{0, 1, 0, 1}));
  for (const char* none :
       {"[]", "{}", "[7]", R"([{"mesh":2}])", R"([{"mesh":-2,"of":0}])", R"([{"mesh":4,"of":0}])",
        R"([{"mesh":0,"of":2}])", R"([{"mesh":2,"of":2}])", R"([{"mesh":2,"of":18446744073709551615}])"}) {
    EXPECT_EQ(origins(none), (Origins{0, 1, 2, 3})) << none;
  }
  EXPECT_EQ(origins(R"([{"mesh":2,"of":0},{"mesh":3,"of":2}])"), (Origins{0, 1, 0, 3})) << "of a part is none";
}

TEST(Meta, ListsTextures) {
  const auto textures = read_textures(R"({"textures":[{"source":2,"sampler":0,"name":"bark"},{},4]})");
  ASSERT_EQ(textures.size(), 3U);
  EXPECT_EQ(textures[0].image, 2);
  EXPECT_EQ(textures[0].name, "bark");
  EXPECT_EQ(textures[1].image, -1);
  EXPECT_EQ(textures[0].sampler, 0);
  EXPECT_EQ(textures[2].image, -1);
  EXPECT_TRUE(read_textures("nonsense").empty());
}

TEST(Meta, AnImageThatAnExtensionNamesIsTheTexturesImage) {
  const auto textures = read_textures(
      R"({"textures":[{"extensions":{"KHR_texture_basisu":{"source":3}}},{"source":1,"extensions":{"EXT_texture_webp":)"
      R"({"source":2}}},{"extensions":{"EXT_texture_webp":{"source":4},"KHR_texture_basisu":{"source":5}}},)"
      R"({"extensions":{"EXT_texture_webp":{"source":18446744073709551615}}},{"extensions":7}]})");
  ASSERT_EQ(textures.size(), 5U);
  EXPECT_EQ(textures[0].image, 3);
  EXPECT_EQ(textures[1].image, 1);
  EXPECT_EQ(textures[2].image, 5);
  EXPECT_EQ(textures[3].image, -1);
  EXPECT_EQ(textures[4].image, -1);
}

TEST(Meta, SettingsAreALineForTheWholeAndOneForEachKindOfMesh) {
  const MetaInfo meta = read_meta(
      R"({"settings":{"preset":"fast","repair":false,"normal_error":0.5,"keep":["NORMAL"],"mesh_settings":
      [{"meshes":[1,2],"error_tier":"qem"},7]}})");
  ASSERT_EQ(meta.setting_lines.size(), 2U);
  EXPECT_EQ(meta.setting_lines[0], R"(preset fast, repair false, normal_error 0.5, keep ["NORMAL"])");
  EXPECT_EQ(meta.setting_lines[1], "meshes [1,2], error_tier qem");
  EXPECT_TRUE(read_meta(R"({"settings":[1]})").setting_lines.empty());
}

}  // namespace
}  // namespace meshlode::app
