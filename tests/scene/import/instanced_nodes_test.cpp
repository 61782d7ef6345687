// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes are instanced: those of the scene that is asked for, without what KHR_node_visibility hides.
#include <gtest/gtest.h>

#include "gltf_builder.h"
#include "scene/import/json.h"

namespace meshlode::testing {
namespace {

/// A square that the nodes draw.
Result<scene::Scene> import_nodes(const std::string& rest, const std::string& choice = "") {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.array(kSquareIndices, 5123, "SCALAR", 1);
  return b.import("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]," + rest,
                  {.scene = choice});
}

std::string names_of(const Result<scene::Scene>& scene) {
  if (!scene) return describe(scene);
  std::string out;
  for (const scene::SceneInstance& instance : scene->instances) out += instance.name + " ";
  return out;
}

const std::string kHidden = ",\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}}";

TEST(ImportVisibility, HiddenNodesAndAllBelowThemAreNotInstanced) {
  const auto scene = import_nodes(
      "\"extensionsRequired\":[\"KHR_node_visibility\"],\"nodes\":["
      "{\"name\":\"a\",\"mesh\":0,\"children\":[1,2]},"
      "{\"name\":\"b\",\"mesh\":0,\"children\":[3]" +
      kHidden +
      "},{\"name\":\"c\",\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{\"visible\":true}}},"
      "{\"name\":\"d\",\"mesh\":0,\"extensions\":{\"KHR_node_visibility\":{}}},"
      "{\"name\":\"e\",\"children\":[5]" +
      kHidden + "},{\"name\":\"f\"}]");
  EXPECT_EQ(names_of(scene), "a c ");
  ASSERT_TRUE(scene);
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "2 instances that KHR_node_visibility hides");
  EXPECT_EQ(scene->meshes.size(), 1U);
  EXPECT_NE(scene->document.find("\"KHR_node_visibility\":{\"visible\":false}"), std::string::npos);
}

TEST(ImportVisibility, WhatIsNoFlagIsRefused) {
  for (const std::string value : {"{\"visible\":0}", "5", "{\"visible\":null}"}) {
    const auto scene = import_nodes("\"nodes\":[{},{\"extensions\":{\"KHR_node_visibility\":" + value + "}}]");
    ASSERT_FALSE(scene) << value;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid);
    EXPECT_NE(scene.error().where.find("/nodes/1/extensions/KHR_node_visibility"), std::string::npos)
        << describe(scene);
  }
}

/// Three roots in three scenes; the second has a name of digits, the default is the last.
const std::string kScenes =
    "\"nodes\":[{\"name\":\"a\",\"mesh\":0},{\"name\":\"b\",\"mesh\":0},{\"name\":\"c\",\"mesh\":0}],"
    "\"scenes\":[{\"name\":\"day\",\"nodes\":[0,1]},{\"name\":\"0\",\"nodes\":[1]},{\"name\":\"night\",\"nodes\":[2,1]}"
    "],"
    "\"scene\":2";

TEST(ImportSceneChoice, ByNameElseByIndexElseAll) {
  EXPECT_EQ(names_of(import_nodes(kScenes)), "c b ");
  EXPECT_EQ(names_of(import_nodes(kScenes, "day")), "a b ");
  EXPECT_EQ(names_of(import_nodes(kScenes, "night")), "c b ");
  EXPECT_EQ(names_of(import_nodes(kScenes, "0")), "b ");  // a name
  EXPECT_EQ(names_of(import_nodes(kScenes, "1")), "b ");
  EXPECT_EQ(names_of(import_nodes(kScenes, "2")), "c b ");
  EXPECT_EQ(names_of(import_nodes(kScenes, "all")), "a b c ");  // each node once
  EXPECT_EQ(names_of(import_nodes("\"nodes\":[{\"name\":\"a\",\"mesh\":0}]", "all")), "a ");
}

TEST(ImportSceneChoice, TheDocumentShowsTheSameScene) {
  const auto document_of = [](const std::string& choice) {
    const auto scene = import_nodes(kScenes, choice);
    EXPECT_TRUE(scene) << describe(scene);
    EXPECT_EQ(scene->choice, choice);
    return *scene::parse_json(scene->document);
  };
  EXPECT_EQ(document_of("").find("scene")->index(), 2U);
  EXPECT_EQ(document_of("day").find("scene")->index(), 0U);
  const auto all = document_of("all");
  EXPECT_EQ(all.find("scene")->index(), 3U);
  ASSERT_EQ(all.items("scenes").size(), 4U);
  EXPECT_EQ(scene::dump_json(all.items("scenes")[3]), "{\"name\":\"all scenes\",\"nodes\":[0,1,2]}");
  const auto left = [](const std::string& choice) { return import_nodes(kScenes, choice)->left_out; };
  ASSERT_EQ(left("").size(), 1U);
  EXPECT_EQ(left("")[0].what, "instances of 2 other scenes");
  EXPECT_EQ(left("day").size(), 1U);
  EXPECT_TRUE(left("all").empty());
}

TEST(ImportSceneChoice, AChoiceThatIsNoneIsAnErrorOfUse) {
  const auto expect_usage = [](const Result<scene::Scene>& scene, const std::string& text) {
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, ErrorCode::kUsage) << describe(scene);
    EXPECT_NE(scene.error().detail.find(text), std::string::npos) << describe(scene);
  };
  for (const std::string choice : {"3", "-1", "1x", "Day", "99999999999999999999"}) {
    expect_usage(import_nodes(kScenes, choice), "its scenes are 0 'day', 1 '0', 2 'night'");
  }
  expect_usage(import_nodes("\"nodes\":[{\"mesh\":0}]", "0"), "the file has none");
  expect_usage(import_nodes("\"nodes\":[{},{}],\"scenes\":[{\"name\":\"a\",\"nodes\":[0]},{\"name\":\"a\"}]", "a"),
               "several scenes have this name");
  const TempFolder folder;
  const auto path = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_usage(scene::import_scene(path, {.scene = "0"}), "only glTF has scenes");
  EXPECT_TRUE(scene::import_scene(path, {.scene = "all"}));
}

}  // namespace
}  // namespace meshlode::testing
