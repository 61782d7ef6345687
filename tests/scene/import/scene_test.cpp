// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes, instances and materials.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "gltf_builder.h"
#include "support/sanitized.h"

namespace meshlode::testing {
namespace {

GltfBuilder square() {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.array(kSquareIndices, 5123, "SCALAR", 1);
  return b;
}
const std::string kMesh =
    "\"meshes\":[{\"name\":\"quad\",\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]";

Vec3d apply(const Mat4d& m, const Vec3d& p) {
  return Vec3d(m * glm::dvec4(p, 1.0));
}

TEST(ImportScene, InstancesAreVisitedDepthFirstWithTransformsComposedInDoubles) {
  // root: far away; child: quarter turn about z and a mirror; its sibling: a matrix.
  const auto scene = square().import(
      kMesh +
      ",\"nodes\":[{\"name\":\"root\",\"mesh\":0,\"translation\":[1000000,0,0],\"children\":[2,1]},"
      "{\"name\":\"last\",\"mesh\":0,\"matrix\":[2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,0.001,1]},"
      "{\"name\":\"turned\",\"rotation\":[0,0,0.7071067811865476,0.7071067811865476],\"scale\":[-1,1,1],"
      "\"children\":[3]},{\"name\":\"leaf\",\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 3U);
  EXPECT_EQ(scene->instances[0].name, "root");
  EXPECT_EQ(scene->instances[1].name, "leaf");
  EXPECT_EQ(scene->instances[1].node, 3U);
  EXPECT_EQ(scene->instances[2].name, "last");
  // (1, 0, 0) -> mirrored (-1, 0, 0) -> turned (0, -1, 0) -> moved
  const Vec3d leaf = apply(scene->instances[1].transform, {1, 0, 0});
  EXPECT_NEAR(leaf.x, 1000000.0, 1e-9);
  EXPECT_NEAR(leaf.y, -1.0, 1e-12);
  EXPECT_LT(glm::determinant(Mat3d(scene->instances[1].transform)), 0.0);
  EXPECT_EQ(apply(scene->instances[2].transform, {1, 1, 1}), Vec3d(1000002, 2, 2.001));
}

// As UniGLTF writes scenes: the object below a parent that the scene does not list.
TEST(ImportScene, WhatASceneListsIsShownWithoutItsParents) {
  const std::string nodes =
      ",\"nodes\":[{\"name\":\"tmpParent\",\"translation\":[9,0,0],\"children\":[1,2]},"
      "{\"mesh\":0,\"translation\":[1,0,0],\"children\":[3]},{\"mesh\":0},{\"mesh\":0,\"translation\":[0,1,0]}],";
  auto scene = square().import(kMesh + nodes + "\"scenes\":[{\"nodes\":[1]}]");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 2U);
  EXPECT_EQ(apply(scene->instances[0].transform, {0, 0, 0}), Vec3d(1, 0, 0));
  EXPECT_EQ(apply(scene->instances[1].transform, {0, 0, 0}), Vec3d(1, 1, 0));
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "parents of nodes that a scene lists (1)");
  // What is carried has no scene that lists a child, and the parent keeps its other one.
  EXPECT_NE(scene->document.find("\"children\":[2]"), std::string::npos) << scene->document;
  scene = square().import(kMesh + nodes + "\"scenes\":[{\"nodes\":[1]},{\"nodes\":[2,1]}],\"scene\":1");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.size(), 3U);
  EXPECT_EQ(scene->document.find("children\":[]"), std::string::npos) << scene->document;
  // Listed itself and by its grandparent, in one scene or in two: shown twice or in two places.
  for (const char* scenes : {"\"scenes\":[{\"nodes\":[0,3]}]", "\"scenes\":[{\"nodes\":[3]},{\"nodes\":[0]}]"}) {
    scene = square().import(kMesh + nodes + scenes);
    ASSERT_FALSE(scene);
    EXPECT_NE(describe(scene).find("a scene lists node 0 too, which is above node 3"), std::string::npos)
        << describe(scene);
  }
}

TEST(ImportScene, WithoutScenesEveryRootIsDrawnAndWithoutADefaultSceneTheFirst) {
  const std::string nodes = ",\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"mesh\":0},{\"mesh\":0}]";
  auto scene = square().import(kMesh + nodes);
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.size(), 3U);
  scene = square().import(kMesh + nodes + ",\"scenes\":[{\"nodes\":[2]},{\"nodes\":[0]}]");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 1U);
  EXPECT_EQ(scene->instances[0].node, 2U);
  scene = square().import(kMesh + nodes + ",\"scenes\":[{\"nodes\":[2]},{\"nodes\":[0]}],\"scene\":1");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.size(), 2U);
}

TEST(ImportScene, ALongChainOfNodesDoesNotUseTheStack) {
  std::string nodes;
  constexpr int kCount = test::kIsSanitized ? 20000 : 100000;  // frames are larger there
  for (int i = 0; i < kCount; ++i) {
    nodes +=
        i + 1 < kCount ? "{\"children\":[" + std::to_string(i + 1) + "],\"translation\":[1,0,0]}," : "{\"mesh\":0}";
  }
  const auto scene = square().import(kMesh + ",\"nodes\":[" + nodes + "]");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 1U);
  EXPECT_EQ(scene->instances[0].transform[3].x, kCount - 1);
}

TEST(ImportScene, OneMeshIsBuiltOnceHoweverManyNodesDrawIt) {
  const auto scene = square().import(kMesh + ",\"nodes\":[{\"mesh\":0},{\"mesh\":0}]");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->meshes.size(), 1U);
  EXPECT_EQ(scene->meshes[0].name, "quad");
  EXPECT_EQ(scene->instances.size(), 2U);
}

TEST(ImportScene, UvSetsAreFoundInExtensionsNobodyKnowsHere) {
  const auto scene = square().import(
      kMesh +
      ",\"images\":[{\"uri\":\"data:image/png;base64,iVBORw==\"}],\"textures\":[{\"source\":0}],\"materials\":["
      "{\"name\":\"m\",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.25,\"doubleSided\":true,"
      "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,0.75],\"baseColorTexture\":{\"index\":0,\"texCoord\":"
      "0,"
      "\"extensions\":{\"KHR_texture_transform\":{\"texCoord\":2}}}},"
      "\"extensions\":{\"ACME_materials_glitter\":{\"layers\":[{\"glitterTexture\":{\"index\":0,\"texCoord\":3}}]}}},"
      "{\"extras\":{\"oldTexture\":{\"index\":0,\"texCoord\":1}}}]");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->materials.size(), 3U);  // two and the default one
  const scene::SceneMaterial& m = scene->materials[0];
  EXPECT_EQ(m.uv_sets_used, (1U << 2U) | (1U << 3U));
  EXPECT_EQ(m.base_color_uv_set, 2U);
  EXPECT_EQ(m.base_color_texture, 0U);
  EXPECT_EQ(m.base_color, Vec4f(0.5F, 0.25F, 1.0F, 0.75F));
  EXPECT_EQ(m.alpha_mode, scene::AlphaMode::kMask);
  EXPECT_EQ(m.alpha_cutoff, 0.25F);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(scene->materials[1].uv_sets_used, 0U);
  EXPECT_EQ(scene->materials[2].source_index, 0xFFFFFFFFu);
  EXPECT_EQ(scene->meshes[0].primitives[0].material, MaterialId(2U));
}

TEST(ImportScene, SpecularGlossinessStandsInThePlaceOfMetallicRoughnessWithDefaultsOfItsOwn) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  const auto scene = b.import(
      mesh_text("\"POSITION\":0") +
      ",\"images\":[{\"uri\":\"data:image/png;base64,iVBORw==\"}],\"textures\":[{\"source\":0}],\"materials\":["
      "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,1,0.75],\"baseColorTexture\":{\"index\":0,\"texCoord\":"
      "2}},"
      "\"extensions\":{\"KHR_materials_pbrSpecularGlossiness\":{}}}]");
  ASSERT_TRUE(scene) << describe(scene);
  const scene::SceneMaterial& m = scene->materials[0];
  EXPECT_EQ(m.base_color, Vec4f(1.0F)) << "not metallic-roughness's";
  EXPECT_EQ(m.base_color_texture, 0xFFFFFFFFu);
  EXPECT_EQ(m.base_color_uv_set, 0xFFFFFFFFu);
  EXPECT_EQ(m.uv_sets_used, 4U) << "a renderer without the extension still samples it";
}

TEST(ImportScene, SkinsAndMorphTargetsLeaveTheStaticTriangles) {
  GltfBuilder b = square();
  const int target = b.floats(kSquare, "VEC3", 3);
  const auto scene = b.import(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"_CUSTOM\":0},\"indices\":1,\"targets\":[{"
      "\"POSITION\":" +
      std::to_string(target) + "}]}]}],\"nodes\":[{\"mesh\":0,\"skin\":0},{}],\"skins\":[{\"joints\":[1]}]");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->meshes[0].primitives[0].indices.size(), 6U);
  const auto says = [&](const std::string& what) {
    return std::any_of(scene->left_out.begin(), scene->left_out.end(), [&](const scene::LeftOut& l) {
      return l.what.find(what) != std::string::npos && !l.why.empty();
    });
  };
  EXPECT_TRUE(says("skin 0"));
  EXPECT_TRUE(says("mesh 0 morph targets"));
  EXPECT_TRUE(says("_CUSTOM"));
  EXPECT_EQ(scene->document.find("\"skin\""), std::string::npos);
}

TEST(ImportScene, OptionalExtensionsFallBackAndRequiredLooksAreCarried) {
  for (const std::string name :
       {"KHR_texture_transform", "KHR_materials_clearcoat", "KHR_lights_punctual", "KHR_mesh_quantization",
        "KHR_texture_basisu", "EXT_texture_webp", "KHR_materials_not_yet_invented"}) {
    const auto scene = square().import(kMesh + ",\"extensionsRequired\":[\"" + name + "\"]");
    EXPECT_TRUE(scene) << describe(scene);
  }
  for (const std::string name : {"EXT_meshopt_compression", "EXT_mesh_gpu_instancing", "ACME_folded_space"}) {
    const auto scene = square().import(kMesh + ",\"extensionsUsed\":[\"" + name + "\"]");
    EXPECT_TRUE(scene) << describe(scene);
  }
}

TEST(ImportScene, OptionalExtensionsThatHoldTheGeometryAreRefused) {
  const auto expect_refused = [](const Result<scene::Scene>& scene, const std::string& where) {
    ASSERT_FALSE(scene) << where;
    EXPECT_EQ(scene.error().code, ErrorCode::kUnsupported) << describe(scene);
    EXPECT_NE(scene.error().message().find(where), std::string::npos) << describe(scene);
  };
  // Four copies that would become one, whether the name is in extensionsUsed or not.
  const std::string name = "KHR_mesh_gpu_instancing";
  for (const std::string& used : {std::string(), ",\"extensionsUsed\":[\"" + name + "\"]"}) {
    GltfBuilder b = square();
    const int moves = b.floats({0, 0, 0, 2, 0, 0, 4, 0, 0, 6, 0, 0}, "VEC3", 3);
    expect_refused(b.import(kMesh + ",\"nodes\":[{},{\"mesh\":0,\"extensions\":{\"" + name +
                            "\":{\"attributes\":{\"TRANSLATION\":" + std::to_string(moves) + "}}}}]" + used),
                   "/nodes/1/extensions/" + name);
  }
  // Vertices that a compression holds: the accessor alone is all zero.
  GltfBuilder hollow;
  hollow.accessor(-1, 5126, 4, "VEC3");
  hollow.array(kSquareIndices, 5123, "SCALAR", 1);
  expect_refused(hollow.import(mesh_text("\"POSITION\":0", ",\"indices\":1,\"extensions\":{\"ACME_packed\":{}}")),
                 "/meshes/0/primitives/0/extensions/ACME_packed");
  GltfBuilder elsewhere;
  elsewhere.accessor(-1, 5126, 4, "VEC3", ",\"extensions\":{\"ACME_stream\":{}}");
  elsewhere.array(kSquareIndices, 5123, "SCALAR", 1);
  expect_refused(elsewhere.import(mesh_text("\"POSITION\":0", ",\"indices\":1")),
                 "/accessors/0/extensions/ACME_stream");
  GltfBuilder coded = square();
  coded.array(std::vector<std::uint16_t>(12), 5123, "VEC3", 3, ",\"extensions\":{\"WEB3D_quantized_attributes\":{}}");
  expect_refused(coded.import(kMesh), "/accessors/2/extensions/WEB3D_quantized_attributes");
  // A view whose bytes another extension holds.
  const std::string views =
      "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36}],\"bufferViews\":[{\"buffer\":0,"
      "\"byteLength\":36,\"extensions\":{\"ACME_packed_views\":{}}}],\"accessors\":[{\"bufferView\":0,"
      "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}]," +
      mesh_text("\"POSITION\":0") + "}";
  const TempFolder folder;
  expect_refused(scene::import_scene(folder.write("scene.gltf", views), {}), "ACME_packed_views");
}

TEST(ImportScene, OptionalExtensionsWithAFallbackAreLeftOut) {
  // The view's own buffer has its bytes, so nothing is lost without the extension.
  GltfBuilder b = square();
  b.views[0].insert(b.views[0].size() - 1, ",\"extensions\":{\"ACME_packed_views\":{\"buffer\":0}}");
  const auto scene = b.import(kMesh + ",\"extensionsUsed\":[\"ACME_packed_views\"]");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->meshes[0].primitives[0].indices.size(), 6U);
  EXPECT_TRUE(square().import(mesh_text("\"POSITION\":0", ",\"indices\":1,\"extensions\":{\"ACME_outline\":{}}")));
}

TEST(ImportScene, TheSourceHashCoversEveryFileReferredTo) {
  const TempFolder folder;
  GltfBuilder b = square();
  const std::string text = b.json(kMesh + ",\"images\":[{\"uri\":\"a.png\"}]", ",\"uri\":\"b.bin\"");
  folder.write("b.bin", std::string(b.bin.begin(), b.bin.end()));
  folder.write("a.png", "one");
  const auto first = scene::import_scene(folder.write("scene.gltf", text), {});
  ASSERT_TRUE(first) << describe(first);
  EXPECT_EQ(first->source_name, "scene.gltf");
  EXPECT_EQ(first->source_hash.size(), 32U);
  EXPECT_EQ(scene::import_scene(folder.path() / "scene.gltf", {}).value().source_hash, first->source_hash);
  folder.write("a.png", "two");
  EXPECT_NE(scene::import_scene(folder.path() / "scene.gltf", {}).value().source_hash, first->source_hash);
}

}  // namespace
}  // namespace meshlode::testing
