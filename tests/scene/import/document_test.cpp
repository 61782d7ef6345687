// SPDX-License-Identifier: GPL-3.0-or-later
// What travels unchanged: images, materials and rigid animation, with nothing that points to bytes that are gone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

using nlohmann::json;

TEST(ImportDocument, ImagesBecomeBlobsFromViewsDataUrisAndFiles) {
  const TempFolder folder;
  folder.write("tex/a b.png", "file bytes");
  GltfBuilder b;
  b.view<std::uint8_t>({0x89, 'P', 'N', 'G', 1, 2, 3});
  const std::string text = b.json(
      "\"images\":[{\"bufferView\":0,\"mimeType\":\"image/png\",\"name\":\"in view\"},"
      "{\"uri\":\"data:image/jpeg;base64,/9j/\"},{\"uri\":\"tex/a%20b.png\",\"extras\":{\"k\":1}},"
      "{\"uri\":\"./tex/../tex/a%20b.png\"}],\"textures\":[{\"source\":2}]",
      ",\"uri\":\"b.bin\"");
  folder.write("b.bin", std::string(b.bin.begin(), b.bin.end()));
  const auto scene = scene::import_scene(folder.write("scene.gltf", text), {});
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->blobs.size(), 3U);  // the last image shares its bytes
  EXPECT_EQ(scene->blobs[0].bytes.size(), 7U);
  EXPECT_EQ(scene->blobs[0].mime_type, "image/png");
  EXPECT_EQ(scene->blobs[1].mime_type, "image/jpeg");
  EXPECT_EQ(std::string(scene->blobs[2].bytes.begin(), scene->blobs[2].bytes.end()), "file bytes");
  const json document = json::parse(scene->document);
  ASSERT_EQ(document["images"].size(), 4U);
  EXPECT_EQ(document["images"][0]["name"], "in view");
  EXPECT_EQ(document["images"][2]["blob"], 2);
  EXPECT_EQ(document["images"][3]["blob"], 2);
  EXPECT_EQ(document["images"][2]["extras"]["k"], 1);
  for (const json& image : document["images"]) {
    EXPECT_FALSE(image.contains("uri"));
    EXPECT_FALSE(image.contains("bufferView"));
  }
  EXPECT_EQ(document["textures"][0]["source"], 2);
}

TEST(ImportDocument, ImagesInBuffersWithoutDataAreRefusedAndEmptyOnesAreEmpty) {
  const TempFolder folder;
  const auto import_view = [&](const std::string& view) {
    const std::string text =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":8}],\"bufferViews\":[{\"buffer\":0," + view +
        "}],\"images\":[{\"bufferView\":0,\"mimeType\":\"image/png\"}]}";
    return scene::import_scene(folder.write("scene.gltf", text), {});
  };
  const auto absent = import_view("\"byteLength\":8");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, ErrorCode::kInvalid);
  EXPECT_NE(absent.error().where.find("/images/0/bufferView"), std::string::npos) << describe(absent);
  const auto compressed = import_view("\"byteLength\":8,\"extensions\":{\"ACME_packed_views\":{}}");
  ASSERT_FALSE(compressed);
  EXPECT_EQ(compressed.error().code, ErrorCode::kUnsupported);
  EXPECT_NE(compressed.error().detail.find("ACME_packed_views"), std::string::npos) << describe(compressed);
  const auto empty = import_view("\"byteOffset\":4,\"byteLength\":0");
  ASSERT_TRUE(empty) << describe(empty);
  ASSERT_EQ(empty->blobs.size(), 1U);
  EXPECT_TRUE(empty->blobs[0].bytes.empty());
}

TEST(ImportDocument, GeometryIsGoneAndEverythingElseStays) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  const auto scene = b.import(
      "\"meshes\":[{\"name\":\"m\",\"extras\":{\"e\":2},\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
      "\"nodes\":[{\"mesh\":0,\"camera\":0,\"extras\":{\"x\":[1.5]},\"extensions\":{\"KHR_lights_punctual\":{\"light\":"
      "0},"
      "\"ACME_points_to_bytes\":{\"bufferView\":0}}}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":"
      "1,"
      "\"znear\":0.1}}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\"}]}},"
      "\"extensionsUsed\":[\"KHR_lights_punctual\",\"KHR_mesh_quantization\"]");
  ASSERT_TRUE(scene) << describe(scene);
  const json document = json::parse(scene->document);
  EXPECT_FALSE(document.contains("accessors"));
  EXPECT_FALSE(document.contains("bufferViews"));
  EXPECT_FALSE(document.contains("buffers"));
  EXPECT_EQ(document["meshes"][0], json({{"name", "m"}, {"extras", {{"e", 2}}}}));
  EXPECT_EQ(document["nodes"][0]["camera"], 0);
  EXPECT_EQ(document["nodes"][0]["extras"]["x"][0], 1.5);
  EXPECT_EQ(document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"], 0);
  EXPECT_FALSE(document["nodes"][0]["extensions"].contains("ACME_points_to_bytes"));
  EXPECT_EQ(document["extensions"]["KHR_lights_punctual"]["lights"].size(), 1U);
  EXPECT_EQ(document["extensionsUsed"], json({"KHR_lights_punctual"}));
}

TEST(ImportDocument, RigidAnimationIsCompactedAndDeformingAnimationIsNot) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);                               // 0: geometry, must not travel
  const int times = b.floats({0, 1}, "SCALAR", 1);            // 1
  const int moves = b.floats({0, 0, 0, 3, 4, 5}, "VEC3", 3);  // 2
  const int weights = b.floats({0, 1}, "SCALAR", 1);          // 3
  const int turns = b.array<std::int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, 5122, "VEC4", 4, ",\"normalized\":true");
  const auto sampler = [&](int output, const std::string& interpolation = "\"STEP\"") {
    return "{\"input\":" + std::to_string(times) + ",\"output\":" + std::to_string(output) +
           ",\"interpolation\":" + interpolation + "}";
  };
  const auto channel = [](int s, int node, const std::string& path) {
    return "{\"sampler\":" + std::to_string(s) + ",\"target\":{\"node\":" + std::to_string(node) + ",\"path\":\"" +
           path + "\"}}";
  };
  const auto scene = b.import(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}],"
      "\"skins\":[{\"joints\":[1]}],\"animations\":[{\"name\":\"run\",\"samplers\":[" +
      sampler(weights) + "," + sampler(moves, "0") + "," + sampler(turns) + "],\"channels\":[" +
      channel(0, 0, "weights") + "," + channel(1, 0, "translation") + "," + channel(2, 0, "rotation") + "," +
      channel(1, 1, "translation") + "]}]");
  ASSERT_TRUE(scene) << describe(scene);
  const json document = json::parse(scene->document);
  const json& animation = document["animations"][0];
  ASSERT_EQ(animation["channels"].size(), 2U);
  EXPECT_EQ(animation["name"], "run");
  ASSERT_EQ(document["accessors"].size(), 3U);
  ASSERT_EQ(scene->blobs.size(), 1U);
  EXPECT_EQ(scene->blobs[0].kind, scene::SceneBlob::Kind::kBuffer);
  EXPECT_EQ(document["buffers"][0]["blob"], 0);
  EXPECT_EQ(document["buffers"][0]["byteLength"], scene->blobs[0].bytes.size());
  // The bytes of the translation's output are where the new accessor says.
  const json& output = document["accessors"][animation["samplers"][0]["output"].get<std::size_t>()];
  const json& view = document["bufferViews"][output["bufferView"].get<std::size_t>()];
  std::vector<float> values(6);
  std::memcpy(values.data(), scene->blobs[0].bytes.data() + view["byteOffset"].get<std::size_t>(), 24);
  EXPECT_EQ(values, (std::vector<float>{0, 0, 0, 3, 4, 5}));
  const json& rotation = document["accessors"][animation["samplers"][1]["output"].get<std::size_t>()];
  EXPECT_EQ(rotation["componentType"], 5122);
  EXPECT_EQ(rotation["normalized"], true);
  // A number, as Babylon's exporter for Maya writes it, is no interpolation.
  EXPECT_FALSE(animation["samplers"][0].contains("interpolation"));
  EXPECT_EQ(animation["samplers"][1]["interpolation"], "STEP");
  for (const std::string what : {"animation 0: 2 channels", "interpolations of animation samplers (1)"}) {
    const bool is_reported = std::any_of(scene->left_out.begin(), scene->left_out.end(),
                                         [&](const scene::LeftOut& l) { return l.what == what; });
    EXPECT_TRUE(is_reported) << what;
  }
}

}  // namespace
}  // namespace meshlode::testing
