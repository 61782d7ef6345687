// SPDX-License-Identifier: GPL-3.0-or-later
// What is not geometry goes through as it was: nodes, names, materials, images, animations, lights, cameras. And a file
// whose document is not what import writes is an error, never a crash.
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "app/export/export.h"
#include "build_scene.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

using nlohmann::json;
using test::Glb;

Glb export_scene(const scene::Scene& scene) {
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  if (!asset) {
    ADD_FAILURE() << asset.error().message();
    return {};
  }
  const auto glb = export_glb(*asset, test::finest_cuts(*asset));
  if (!glb) {
    ADD_FAILURE() << glb.error().message();
    return {};
  }
  Glb parsed = Glb::parse(*glb);
  parsed.expect_sound();
  return parsed;
}

std::vector<std::uint8_t> bytes_of(const std::vector<float>& values) {
  std::vector<std::uint8_t> bytes(values.size() * 4);
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

TEST(ExportDocument, NodesNamesExtrasAndUnknownExtensionsStay) {
  const scene::Scene scene = test::make_rock_scene(6);
  const Glb glb = export_scene(scene);
  const json source = json::parse(scene.document);
  EXPECT_EQ(glb.json["scenes"], source["scenes"]);
  EXPECT_EQ(glb.json["nodes"], source["nodes"]);
  EXPECT_EQ(glb.json["materials"], source["materials"]);
  EXPECT_EQ(glb.json["asset"]["copyright"], "somebody");
  EXPECT_EQ(glb.json["meshes"][0]["name"], "rock");
  EXPECT_EQ(glb.json["meshes"][0]["extras"], source["meshes"][0]["extras"]);
}

TEST(ExportDocument, MaterialVariantsComeBackWithTheirPrimitives) {
  scene::Scene scene = test::make_rock_scene(6);
  json document = json::parse(scene.document);
  const json first = json::parse(R"({"KHR_materials_variants":{"mappings":[{"material":1,"variants":[0]}]}})");
  const json last = json::parse(R"({"KHR_materials_variants":{"mappings":[{"material":0,"variants":[0]}]}})");
  document["extensionsUsed"] = {"KHR_materials_variants"};
  document["extensions"]["KHR_materials_variants"]["variants"] = json::parse(R"([{"name":"wet"}])");
  document["meshes"][0]["primitives"] =
      json::array({{{"material", 0}, {"extensions", first}}, {{"extensions", last}}, 7, json::object()});
  scene.document = document.dump();
  const Glb glb = export_scene(scene);
  EXPECT_EQ(glb.json["extensions"]["KHR_materials_variants"]["variants"][0]["name"], "wet");
  const auto& primitives = glb.json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 3U);  // of materials 0, 1 and the default one
  EXPECT_EQ(primitives[0]["extensions"], first);
  EXPECT_FALSE(primitives[1].contains("extensions"));
  EXPECT_EQ(primitives[2]["extensions"], last);
}

TEST(ExportDocument, ImagesAnimationsLightsAndCamerasStay) {
  scene::Scene scene = test::make_rock_scene(6);
  json document = json::parse(scene.document);
  document["images"] = json::parse(R"([{"blob": 0, "mimeType": "image/png"}, {"blob": 1, "name": "two"}])");
  document["samplers"] = json::parse(R"([{"wrapS": 33071}])");
  document["textures"] = json::parse(R"([{"source": 0, "sampler": 0}, {"source": 1}])");
  document["materials"][0]["pbrMetallicRoughness"] = json::parse(R"({"baseColorTexture": {"index": 0}})");
  document["cameras"] = json::parse(R"([{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}])");
  document["nodes"][0]["camera"] = 0;
  document["extensionsUsed"] = {"KHR_lights_punctual", "KHR_mesh_quantization", "KHR_draco_mesh_compression"};
  document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  document["extensions"] = json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point"}]}})");
  document["buffers"] = json::parse(R"([{"blob": 2, "byteLength": 28}])");
  document["bufferViews"] =
      json::parse(R"([{"buffer": 0, "byteLength": 8}, {"buffer": 0, "byteOffset": 8, "byteLength": 20}])");
  document["accessors"] = json::parse(
      R"([{"bufferView": 0, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
          {"bufferView": 1, "componentType": 5126, "count": 1, "type": "VEC3"}])");
  document["animations"] = json::parse(
      R"([{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
           "samplers": [{"input": 0, "output": 1}]}])");
  scene.document = document.dump();
  scene.blobs = {{scene::SceneBlob::Kind::kImage, "one.png", "image/png", 0, {0x89, 'P', 'N', 'G', 1}},
                 {scene::SceneBlob::Kind::kImage, "two.jpg", "image/jpeg", 1, {0xFF, 0xD8, 0xFF}},
                 {scene::SceneBlob::Kind::kBuffer, "", "", 0, bytes_of({0, 1, 2, 3, 4, 5, 6})}};
  const Glb glb = export_scene(scene);
  for (const char* key : {"samplers", "textures", "cameras", "animations", "extensions"}) {
    EXPECT_EQ(glb.json[key], document[key]) << key;
  }
  EXPECT_EQ(glb.json["materials"], document["materials"]);
  EXPECT_EQ(glb.json["extensionsUsed"], json::array({"KHR_lights_punctual"}));
  EXPECT_FALSE(glb.json.contains("extensionsRequired"));
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& image = glb.json["images"][i];
    EXPECT_EQ(glb.view_bytes(image["bufferView"]), scene.blobs[i].bytes);
    EXPECT_EQ(image["mimeType"], scene.blobs[i].mime_type);
    EXPECT_FALSE(image.contains("blob"));
  }
  EXPECT_EQ(glb.json["images"][0]["name"], "one.png");
  EXPECT_EQ(glb.json["images"][1]["name"], "two");
  EXPECT_EQ(glb.rows(0)[1][0], 1.0) << "the animation's accessors keep their indices";
  EXPECT_EQ(glb.rows(1)[0], (std::vector<double>{2, 3, 4}));
}

TEST(ExportDocument, ABlobIsWrittenOnceHoweverManyImagesNameIt) {
  scene::Scene scene = test::make_rock_scene(6);
  scene.blobs.resize(1);
  scene.blobs[0].kind = scene::SceneBlob::Kind::kImage;
  scene.blobs[0].name = std::string(5000, 'n');  // nor is a long name multiplied
  scene.blobs[0].bytes.assign(100000, 7);
  std::string images;
  for (int i = 0; i < 200; ++i) images += std::string(images.empty() ? "" : ",") + R"({"blob":0})";
  scene.document = R"({"images":[)" + images + "]}";
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto glb = export_glb(*asset, std::vector<std::vector<ClusterId>>(asset->meshes().size()));
  ASSERT_TRUE(glb.ok()) << glb.error().message();
  EXPECT_LT(glb->size(), 150000u);
  const Glb parsed = Glb::parse(*glb);
  ASSERT_EQ(parsed.json["images"].size(), 200u);
  for (const auto& image : parsed.json["images"]) {
    const auto& view = parsed.json["bufferViews"][image["bufferView"].get<std::size_t>()];
    EXPECT_EQ(view["byteLength"], 100000);
  }
}

TEST(ExportDocument, WithoutADocumentInstancesBecomeNodesAndRecordsMaterials) {
  scene::Scene scene = test::make_rock_scene(6);
  scene.document = "{}";
  scene.materials[1].name = "leaf";
  scene.materials[1].alpha_mode = scene::AlphaMode::kMask;
  scene.materials[1].double_sided = true;
  const Glb glb = export_scene(scene);
  ASSERT_EQ(glb.json["nodes"].size(), 1U);
  EXPECT_EQ(glb.json["nodes"][0]["name"], "child");
  EXPECT_EQ(glb.json["nodes"][0]["matrix"], json::parse("[1,0,0,0, 0,1,0,0, 0,0,1,0, 1,2,3,1]"));
  EXPECT_EQ(glb.json["scenes"][0]["nodes"], json::array({0}));
  ASSERT_EQ(glb.json["materials"].size(), 2U);
  EXPECT_EQ(glb.json["materials"][1]["name"], "leaf");
  EXPECT_EQ(glb.json["materials"][1]["alphaMode"], "MASK");
  EXPECT_EQ(glb.json["materials"][1]["doubleSided"], true);
}

TEST(ExportDocument, ADocumentOfAnotherShapeIsAnError) {
  const std::string deep = R"({"nodes": )" + std::string(100000, '[') + std::string(100000, ']') + "}";
  const char* const documents[] = {"",  // this one is as good as {}
                                   "[]",
                                   "{",
                                   "7",
                                   "null",
                                   "\"text\"",
                                   R"({"nodes": 7})",
                                   R"({"nodes": [7]})",
                                   R"({"nodes": [{"mesh": 9}]})",
                                   R"({"nodes": [{"mesh": -1}]})",
                                   R"({"nodes": [{"mesh": "a"}]})",
                                   R"({"nodes": [], "images": [{"blob": 3}]})",
                                   R"({"images": [{"blob": -1}]})",
                                   R"({"images": [{"blob": "x"}]})",
                                   R"({"images": [3]})",
                                   R"({"images": {}})",
                                   R"({"buffers": [{"blob": 0}]})",
                                   R"({"buffers": 3})",
                                   R"({"bufferViews": [{"buffer": 0, "byteLength": 3}]})",
                                   R"({"bufferViews": [{}]})",
                                   R"({"bufferViews": {}})",
                                   R"({"accessors": 3})",
                                   R"({"materials": 3})",
                                   R"({"materials": []})",
                                   R"({"meshes": 3})",
                                   R"({"meshes": [3]})",
                                   R"({"meshes": [{"name": 3}]})",
                                   R"({"asset": 3})",
                                   R"({"extensionsUsed": 3})",
                                   R"({"extensionsUsed": [3]})",
                                   R"({"scenes": 3})",
                                   deep.c_str()};
  int refused = 0;
  for (const char* document : documents) {
    scene::Scene scene = test::make_rock_scene(4);
    scene.document = document;
    const auto bytes = test::build_bytes(scene);
    if (bytes.empty()) continue;
    const auto asset = run::Asset::from_bytes(bytes);
    if (!asset) continue;  // the reader's business
    const auto glb = export_glb(*asset, test::finest_cuts(*asset));
    if (!glb) {
      ++refused;
      EXPECT_EQ(glb.error().code, ErrorCode::kInvalid) << document;
    }
  }
  EXPECT_GT(refused, 10);
}

}  // namespace
}  // namespace meshlode::app
