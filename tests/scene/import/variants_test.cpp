// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_materials_variants: mappings travel with their mesh, one for each material.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/import/json.h"

namespace meshlode::testing {
namespace {

/// A primitive of the unit square; `material` below 0: none. `mappings`: the text of its list, empty without any.
std::string primitive(int material, const std::string& mappings) {
  std::string text = "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":1},\"indices\":2";
  if (material >= 0) text += ",\"material\":" + std::to_string(material);
  if (!mappings.empty()) text += ",\"extensions\":{\"KHR_materials_variants\":{\"mappings\":" + mappings + "}}";
  return text + "}";
}

Result<scene::Scene> import_meshes(const std::string& meshes) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  b.array(kSquareIndices, 5123, "SCALAR", 1);
  return b.import(
      "\"extensionsUsed\":[\"KHR_materials_variants\"],\"extensions\":{\"KHR_materials_variants\":{\"variants\":"
      "[{\"name\":\"wet\"},{\"name\":\"dry\"}]}},\"textures\":[{}],\"materials\":[{\"name\":\"a\"},{\"name\":\"b\"},"
      "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"texCoord\":1}}}],\"meshes\":[" +
      meshes + "],\"nodes\":[{\"mesh\":0}]");
}

std::string mesh(const std::string& primitives) {
  return "{\"primitives\":[" + primitives + "]}";
}

const std::string kWet = "[{\"material\":1,\"variants\":[0]}]",
                  kDry = "[{\"material\":2,\"variants\":[1,0],\"name\":\"x\"}]";

std::string carried(const scene::Scene& scene) {
  const auto document = scene::parse_json(scene.document);
  EXPECT_TRUE(document);
  std::string out;
  for (const scene::Json& one : document->items("meshes")) out += scene::dump_json(one) + " ";
  return out;
}

TEST(ImportVariants, MappingsTravelWithTheirMaterial) {
  const auto scene = import_meshes(
      mesh(primitive(0, kWet) + "," + primitive(1, "") + "," + primitive(-1, kDry) + "," + primitive(0, kWet)));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(scene->left_out.empty());
  EXPECT_EQ(carried(*scene),
            "{\"primitives\":[{\"material\":0,\"extensions\":{\"KHR_materials_variants\":{\"mappings\":" + kWet +
                "}}},{\"extensions\":{\"KHR_materials_variants\":{\"mappings\":" + kDry + "}}}]} ");
  EXPECT_NE(scene->document.find("\"variants\":[{\"name\":\"wet\"},{\"name\":\"dry\"}]"), std::string::npos);
  EXPECT_NE(scene->document.find("\"extensionsUsed\":[\"KHR_materials_variants\"]"), std::string::npos);
}

TEST(ImportVariants, WhatCannotBeToldApartIsLeftOutAndSaid) {
  const auto scene = import_meshes(mesh(primitive(0, kWet) + "," + primitive(0, kDry) + "," + primitive(1, kWet) + "," +
                                        primitive(-1, kWet) + "," + primitive(-1, "")));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(
      carried(*scene),
      "{\"primitives\":[{\"material\":1,\"extensions\":{\"KHR_materials_variants\":{\"mappings\":" + kWet + "}}}]} ");
  ASSERT_EQ(scene->left_out.size(), 2U);
  EXPECT_EQ(scene->left_out[0].what, "mesh 0 KHR_materials_variants of material 0");
}

TEST(ImportVariants, UvSetsOfAVariantAreKept) {
  const auto plain = import_meshes(mesh(primitive(0, kWet)));
  const auto textured = import_meshes(mesh(primitive(0, kDry)));
  ASSERT_TRUE(plain && textured);
  EXPECT_EQ(plain->materials[0].uv_sets_used, 0U);
  EXPECT_EQ(textured->materials[0].uv_sets_used, 2U);
}

TEST(ImportVariants, MeshesThatDifferInThemAreTwo) {
  const auto same = import_meshes(mesh(primitive(0, kWet)) + "," + mesh(primitive(0, kWet)));
  const auto other = import_meshes(mesh(primitive(0, kWet)) + "," + mesh(primitive(0, kDry)));
  ASSERT_TRUE(same && other);
  EXPECT_TRUE(same->meshes[1].primitives.empty());
  EXPECT_FALSE(other->meshes[1].primitives.empty());
}

TEST(ImportVariants, IndicesAndTypesAreChecked) {
  for (const std::string mappings :
       {"[{\"material\":3}]", "[{\"variants\":[0]}]", "[{\"material\":0,\"variants\":[2]}]", "[{\"material\":-1}]",
        "[7]", "{}", "[{\"material\":0,\"variants\":5}]"}) {
    const auto scene = import_meshes(mesh(primitive(0, mappings)));
    ASSERT_FALSE(scene) << mappings;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid);
    EXPECT_NE(scene.error().where.find("/meshes/0/primitives/0/extensions/KHR_materials_variants/mappings"),
              std::string::npos)
        << describe(scene);
  }
}

}  // namespace
}  // namespace meshlode::testing
