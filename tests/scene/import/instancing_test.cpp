// SPDX-License-Identifier: GPL-3.0-or-later
// EXT_mesh_gpu_instancing: each instance is a node with a name and a place of its own, and as many of them as the file
// has bytes for.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "gltf_builder.h"
#include "scene/import/json.h"

namespace meshlode::testing {
namespace {

GltfBuilder square() {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.array(kSquareIndices, 5123, "SCALAR", 1);
  return b;
}

const std::string kMeshes = "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}]";

/// A node of mesh 0 whose instances have these attributes.
std::string instanced(const std::string& attributes, const std::string& more = "") {
  return "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{" + attributes + "}}}" + more + "}";
}

std::string with_nodes(const std::string& nodes) {
  return kMeshes + ",\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"nodes\":[" + nodes +
         "],\"scenes\":[{\"nodes\":[0]}]";
}

void expect_near(const Mat4d& a, const Mat4d& b) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) EXPECT_NEAR(a[c][r], b[c][r], 1e-6) << "column " << c << " row " << r;
  }
}

TEST(ImportInstancing, EachInstanceStandsWhereItsAttributesSay) {
  GltfBuilder b = square();
  b.floats({1, 2, 3, 4, 5, 6}, "VEC3", 3);                                                                          // 2
  b.array(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170}, 5122, "VEC4", 4, ",\"normalized\":true");  // 3
  b.floats({1, 1, 1, 2, 3, 4}, "VEC3", 3);                                                                          // 4
  const auto scene = b.import(with_nodes(instanced("\"TRANSLATION\":2,\"ROTATION\":3,\"SCALE\":4",
                                                   ",\"name\":\"tree\",\"children\":[1],\"translation\":[10,0,0]") +
                                         ",{\"mesh\":0,\"name\":\"child\"}"));
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 3U);
  const auto& [first, second, child] = std::array{scene->instances[0], scene->instances[1], scene->instances[2]};
  EXPECT_EQ(first.name, "tree[0]");
  EXPECT_EQ(second.name, "tree[1]");
  EXPECT_EQ(child.name, "child");
  EXPECT_EQ(first.node, 2U);  // behind the file's own nodes
  EXPECT_EQ(second.node, 3U);
  EXPECT_EQ(child.node, 1U);
  Mat4d expected(1.0);
  expected[3] = {11.0, 2.0, 3.0, 1.0};
  expect_near(first.transform, expected);
  // A quarter turn around z, of a box scaled by 2, 3 and 4.
  expected[0] = {0.0, 2.0, 0.0, 0.0};
  expected[1] = {-3.0, 0.0, 0.0, 0.0};
  expected[2] = {0.0, 0.0, 4.0, 0.0};
  expected[3] = {14.0, 5.0, 6.0, 1.0};
  expect_near(second.transform, expected);
}

TEST(ImportInstancing, TheDocumentCarriesThemAsNodesThatAnyReaderKnows) {
  GltfBuilder b = square();
  b.floats({1, 2, 3, 4, 5, 6}, "VEC3", 3);
  b.floats({0, 0, 0, 2, 0, 0, 0, 1}, "VEC4", 4);
  const auto scene = b.import(with_nodes(instanced("\"TRANSLATION\":2,\"ROTATION\":3", ",\"children\":[1]") + ",{}"));
  ASSERT_TRUE(scene) << describe(scene);
  const auto document = scene::parse_json(scene->document);
  ASSERT_TRUE(document);
  EXPECT_EQ(scene->document.find("gpu_instancing"), std::string::npos);
  const auto& nodes = document->items("nodes");
  ASSERT_EQ(nodes.size(), 4U);
  EXPECT_EQ(scene::dump_json(nodes[0]), "{\"children\":[2,3,1]}");
  EXPECT_EQ(scene::dump_json(nodes[2]),
            "{\"name\":\"node 0[0]\",\"mesh\":0,\"translation\":[1.0,2.0,3.0],\"rotation\":[0.0,0.0,0.0,1.0]}");
  EXPECT_TRUE(scene->left_out.empty());
}

TEST(ImportInstancing, RotationsOfEveryTypeAndMissingAttributesAreRead) {
  for (const int kind : {0, 1, 2}) {
    GltfBuilder b = square();
    if (kind == 0) b.floats({0, 0, 0.70710678F, 0.70710678F}, "VEC4", 4);
    if (kind == 1) b.array(std::vector<std::int8_t>{0, 0, 90, 90}, 5120, "VEC4", 4, ",\"normalized\":true");
    if (kind == 2) b.array(std::vector<std::int16_t>{0, 0, 23170, 23170}, 5122, "VEC4", 4, ",\"normalized\":true");
    const auto scene = b.import(with_nodes(instanced("\"ROTATION\":2")));
    ASSERT_TRUE(scene) << describe(scene);
    ASSERT_EQ(scene->instances.size(), 1U);
    Mat4d expected(1.0);
    expected[0] = {0.0, 1.0, 0.0, 0.0};
    expected[1] = {-1.0, 0.0, 0.0, 0.0};
    expect_near(scene->instances[0].transform, expected);
  }
  GltfBuilder b = square();
  b.array(std::vector<std::uint16_t>{1, 2, 3}, 5123, "SCALAR", 1);
  const auto scene = b.import(with_nodes(instanced("\"_ID\":2")));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.size(), 3U);
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "instance attribute _ID");
}

TEST(ImportInstancing, WithoutAMeshOrWithoutInstancesNothingIsDrawn) {
  GltfBuilder b = square();
  b.floats({1, 2, 3}, "VEC3", 3);
  const auto scene =
      b.import(with_nodes("{\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":2}}}}"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(scene->instances.empty());
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_NE(scene->left_out[0].what.find("EXT_mesh_gpu_instancing"), std::string::npos);
  GltfBuilder none = square();
  none.accessor(-1, 5126, 0, "VEC3");
  const auto empty = none.import(with_nodes(instanced("\"TRANSLATION\":2")));
  ASSERT_TRUE(empty) << describe(empty);
  EXPECT_TRUE(empty->instances.empty());
}

TEST(ImportInstancing, WhatIsNotAsTheExtensionHasItIsRefusedWithItsPlace) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::string here = "/nodes/0/extensions/EXT_mesh_gpu_instancing";
  const auto expect_refused = [&](const GltfBuilder& b, const std::string& node, const std::string& place) {
    const auto scene = b.import(with_nodes(node));
    ASSERT_FALSE(scene) << node;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid) << describe(scene);
    EXPECT_NE(scene.error().where.find(place), std::string::npos) << describe(scene);
  };
  GltfBuilder b = square();
  b.floats({1, 2, 3, 4, 5, 6}, "VEC3", 3);                                                   // 2
  b.floats({1, 1, 1}, "VEC3", 3);                                                            // 3
  b.floats({0, 0, 0, 0}, "VEC4", 4);                                                         // 4: turned by nothing
  b.floats({0, nan, 0}, "VEC3", 3);                                                          // 5
  b.floats({0, 0, inf, 0}, "VEC4", 4);                                                       // 6
  b.array(std::vector<std::int16_t>{0, 0, 0, 1}, 5122, "VEC4", 4);                           // 7: not normalized
  b.array(std::vector<std::uint16_t>{0, 0, 0, 1}, 5123, "VEC4", 4, ",\"normalized\":true");  // 8: not signed
  expect_refused(b, instanced("\"TRANSLATION\":9"), here + "/attributes/TRANSLATION");
  expect_refused(b, instanced("\"TRANSLATION\":2,\"SCALE\":3"), here + "/attributes/SCALE");
  expect_refused(b, instanced("\"TRANSLATION\":4"), here + "/attributes/TRANSLATION");
  expect_refused(b, instanced("\"SCALE\":1"), here + "/attributes/SCALE");
  for (const int accessor : {3, 7, 8}) {
    expect_refused(b, instanced("\"ROTATION\":" + std::to_string(accessor)), here + "/attributes/ROTATION");
  }
  expect_refused(b, instanced("\"ROTATION\":4"), here + "/attributes");
  expect_refused(b, instanced("\"TRANSLATION\":5"), here + "/attributes");
  expect_refused(b, instanced("\"ROTATION\":6"), here + "/attributes");
  expect_refused(b, instanced(""), here + "/attributes");
  expect_refused(b, "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":7}}", here);
  expect_refused(b, "{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":{\"attributes\":[]}}}", here);
}

// Counts without bytes, the same bytes named by many nodes, and one long name for many instances.
TEST(ImportInstancing, NoMoreInstancesThanTheFileHasBytesFor) {
  const auto expect_too_many = [](const Result<scene::Scene>& scene) {
    ASSERT_FALSE(scene);
    EXPECT_NE(scene.error().detail.find("size of the file"), std::string::npos) << describe(scene);
  };
  const auto start = std::chrono::steady_clock::now();
  GltfBuilder hollow = square();
  hollow.accessor(-1, 5126, 2147483647, "VEC3");
  expect_too_many(hollow.import(with_nodes(instanced("\"TRANSLATION\":2"))));

  GltfBuilder shared = square();
  shared.floats(std::vector<float>(3 * 4000, 1.0F), "VEC3", 3);
  std::string nodes = "{}";
  for (int i = 0; i < 30; ++i) nodes += "," + instanced("\"TRANSLATION\":2");
  expect_too_many(shared.import(with_nodes(nodes)));
  EXPECT_TRUE(shared.import(with_nodes(instanced("\"TRANSLATION\":2"))));

  const std::string name = ",\"name\":\"" + std::string(100000, 'n') + "\"";
  expect_too_many(shared.import(with_nodes(instanced("\"TRANSLATION\":2", name))));
  GltfBuilder some = square();
  some.accessor(-1, 5126, 20000, "VEC3");
  EXPECT_TRUE(some.import(with_nodes(instanced("\"TRANSLATION\":2"))));
  expect_too_many(some.import(with_nodes(instanced("\"TRANSLATION\":2")), {.max_decoded = std::uint64_t{1} << 20U}));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

}  // namespace
}  // namespace meshlode::testing
