// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that are equal to the last bit, material and all, are built once, and no name is lost by it.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/import/json.h"

namespace meshlode::testing {
namespace {

/// Two copies of a square in buffers of their own, one that is turned, and one that is a little off.
GltfBuilder squares() {
  GltfBuilder b;
  std::vector<float> off = kSquare;
  off[0] = 1e-30F;
  b.floats(kSquare, "VEC3", 3);                                              // 0
  b.floats(kSquare, "VEC3", 3);                                              // 1
  b.floats(off, "VEC3", 3);                                                  // 2
  b.array(kSquareIndices, 5123, "SCALAR", 1);                                // 3
  b.array(std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}, 5125, "SCALAR", 1);  // 4
  b.array(std::vector<std::uint32_t>{0, 2, 1, 0, 3, 2}, 5125, "SCALAR", 1);  // 5
  return b;
}

std::string mesh(const std::string& name, int positions, int indices, const std::string& more = "") {
  return "{\"name\":\"" + name + "\",\"primitives\":[{\"attributes\":{\"POSITION\":" + std::to_string(positions) +
         "},\"indices\":" + std::to_string(indices) + more + "}]}";
}

std::string scene_of(const std::vector<std::string>& meshes) {
  std::string list, nodes;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    list += (i == 0 ? "" : ",") + meshes[i];
    nodes += (i == 0 ? "" : ",") + std::string("{\"mesh\":") + std::to_string(i) + "}";
  }
  return "\"materials\":[{},{}],\"meshes\":[" + list + "],\"nodes\":[" + nodes + "]";
}

TEST(ImportMergesMeshes, EqualOnesAreThereOnce) {
  const auto scene = squares().import(scene_of({mesh("a", 0, 3), mesh("b", 2, 4), mesh("c", 1, 4), mesh("d", 0, 4)}));
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->meshes.size(), 4U);
  EXPECT_EQ(scene->meshes[2].name, "c");
  EXPECT_EQ(scene->meshes[0].primitives.size(), 1U);
  EXPECT_EQ(scene->meshes[1].primitives.size(), 1U);
  EXPECT_TRUE(scene->meshes[2].primitives.empty());
  EXPECT_TRUE(scene->meshes[3].primitives.empty());
  std::vector<std::uint32_t> drawn;
  for (const auto& instance : scene->instances) drawn.push_back(instance.mesh.value);
  EXPECT_EQ(drawn, (std::vector<std::uint32_t>{0, 1, 0, 0}));
  const auto document = scene::parse_json(scene->document);
  ASSERT_TRUE(document);
  EXPECT_EQ(document->items("nodes")[2].find("mesh")->index(), 0U);
  EXPECT_EQ(*document->items("meshes")[2].find("name")->string(), "c");
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "second copies of 2 meshes: 2 'c', 3 'd'");
}

TEST(ImportMergesMeshes, OthersAreNot) {
  const auto expect_kept = [](const std::string& a, const std::string& b) {
    const auto scene = squares().import(scene_of({a, b}));
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_TRUE(scene->left_out.empty()) << a << b;
    EXPECT_EQ(scene->instances[1].mesh.value, 1U);
  };
  expect_kept(mesh("a", 0, 3), mesh("b", 2, 3));                                        // a bit of a position
  expect_kept(mesh("a", 0, 4), mesh("b", 0, 5));                                        // turned
  expect_kept(mesh("a", 0, 3), mesh("b", 0, 3, ",\"material\":1"));                     // another material
  expect_kept(mesh("a", 0, 3, ",\"material\":0"), mesh("b", 0, 3, ",\"material\":1"));  // the same
  const auto empty = squares().import(scene_of({mesh("a", 0, 3, ",\"mode\":1"), mesh("b", 0, 3, ",\"mode\":1")}));
  ASSERT_TRUE(empty);  // lines: nothing to share
  EXPECT_EQ(empty->instances[1].mesh.value, 1U);
}

}  // namespace
}  // namespace meshlode::testing
