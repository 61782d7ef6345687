// SPDX-License-Identifier: GPL-3.0-or-later
// Skinned meshes in the rest pose of the file, against positions worked out by hand (glTF 2.0, section 3.7.3.3).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

using nlohmann::json;

/// A triangle whose corners have one joint each; further attributes and nodes are up to the test.
struct SkinnedTriangle {
  std::string text(const std::string& nodes, const std::string& skins, const std::string& rest = "") {
    return "\"meshes\":[{\"name\":\"m\",\"primitives\":[{\"attributes\":{" + attributes + "}}]}],\"nodes\":[" + nodes +
           "],\"skins\":[" + skins + "]" + (rest.empty() ? "" : "," + rest);
  }
  void joints(const std::vector<std::uint8_t>& values) {
    attributes += ",\"JOINTS_0\":" + std::to_string(b.array<std::uint8_t>(values, 5121, "VEC4", 4));
  }
  void weights(const std::vector<float>& values) {
    attributes += ",\"WEIGHTS_0\":" + std::to_string(b.floats(values, "VEC4", 4));
  }

  GltfBuilder b;
  int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  std::string attributes = "\"POSITION\":" + std::to_string(positions);
};

bool says(const scene::Scene& scene, const std::string& what, const std::string& why) {
  for (const scene::LeftOut& each : scene.left_out) {
    if (each.what.find(what) != std::string::npos && each.why.find(why) != std::string::npos) return true;
  }
  return false;
}

/// World positions of the only instance of a mesh.
std::vector<Vec3d> placed(const scene::Scene& scene, std::size_t instance = 0) {
  std::vector<Vec3d> out;
  const scene::SceneInstance& i = scene.instances.at(instance);
  for (const Vec3d& p : scene.meshes.at(i.mesh.value).primitives.at(0).positions) {
    const auto q = i.transform * glm::dvec4(p.x, p.y, p.z, 1.0);
    out.emplace_back(q.x, q.y, q.z);
  }
  return out;
}

void expect_near(const std::vector<Vec3d>& found, const std::vector<Vec3d>& expected, double tolerance = 1e-12) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[i][c], expected[i][c], tolerance) << i;
  }
}

// Centimetres, inverse bind matrices of a hundredth, a joint at x = 5 below a node at y = 1, the mesh's node elsewhere.
TEST(ImportSkins, OneMatrixForAllStaysAMatrixAndTheMeshsNodeSaysNothing) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const int inverse = t.b.floats({0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1}, "MAT4", 16);
  const auto scene = t.b.import(t.text(
      "{\"name\":\"body\",\"mesh\":0,\"skin\":0,\"translation\":[50,0,0],\"extras\":{\"k\":1},\"children\":[3]},"
      "{\"translation\":[0,1,0],\"children\":[2]},{\"name\":\"joint\",\"translation\":[5,0,0]},{\"name\":\"hat\"}",
      "{\"joints\":[2],\"inverseBindMatrices\":" + std::to_string(inverse) + "}",
      "\"scenes\":[{\"nodes\":[0,1]},{\"nodes\":[1]},{\"nodes\":[0]}],\"scene\":0"));
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(scene->instances.size(), 1U);
  expect_near(placed(*scene), {{5, 1, 0}, {5.5, 1, 0}, {5, 1.5, 0}});
  EXPECT_EQ(scene->meshes[0].primitives[0].positions[1], Vec3d(1, 0, 0));  // the mesh itself is as it was
  EXPECT_EQ(scene->instances[0].name, "body");
  EXPECT_EQ(scene->instances[0].node, 4U);
  EXPECT_TRUE(says(*scene, "skin 0", "rest pose"));
  const json document = json::parse(scene->document);
  EXPECT_EQ(document["nodes"][0],
            json({{"name", "body"}, {"translation", {50, 0, 0}}, {"extras", {{"k", 1}}}, {"children", {3}}}));
  EXPECT_EQ(document["nodes"][4], json({{"name", "body"},
                                        {"extras", {{"k", 1}}},
                                        {"mesh", 0},
                                        {"matrix", {0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 5, 1, 0, 1}}}));
  // In the scenes of its node's root alone.
  EXPECT_EQ(document["scenes"][0]["nodes"], json({0, 1, 4}));
  EXPECT_EQ(document["scenes"][1]["nodes"], json({1}));
  EXPECT_EQ(document["scenes"][2]["nodes"], json({0, 4}));
}

// Two joints, each with the inverse of where it stands: nothing moves, whatever the node says.
TEST(ImportSkins, TheRestPoseThatIsTheBindPoseLeavesEveryBit) {
  SkinnedTriangle t;
  t.joints({0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  t.weights({0.25F, 0.75F, 0, 0, 1, 0, 0, 0, 0.1F, 0.9F, 0, 0});
  const float third = 1.0F / 3.0F;
  const int inverse = t.b.floats({1, 0,  0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -third, 0, 0, 1,  //
                                  0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, -2,     0, 0, 1},
                                 "MAT4", 16);
  const auto scene =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0,\"scale\":[9,9,9]},{\"translation\":[0.33333334,0,0],\"children\":[2]},"
                        "{\"translation\":[-0.33333334,2,0],\"rotation\":[0,0,0.70710677,0.70710677]}",
                        "{\"joints\":[1,2],\"inverseBindMatrices\":" + std::to_string(inverse) + "}"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.at(0).transform, Mat4d(1.0));
  EXPECT_EQ(placed(*scene), (std::vector<Vec3d>{Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)}));
}

// Corners at (0,0), (1,0) and (0,1): the first follows joint 0, the second joint 1, the third each by half.
TEST(ImportSkins, VerticesGoWhereTheirJointsPutThem) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 2, 2, 0, 0});  // not of sum 1: made so
  t.attributes += ",\"NORMAL\":" + std::to_string(t.b.floats({0, 0, 1, 1, 0, 0, 0, 0, 1}, "VEC3", 3));
  // Joint 1 turns x to y and doubles z; without inverse bind matrices.
  const auto scene =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0,\"translation\":[7,7,7]},{\"translation\":[0,0,3]},"
                        "{\"matrix\":[0,1,0,0,-1,0,0,0,0,0,2,0,10,0,0,1]}",
                        "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(scene->instances.at(0).transform, Mat4d(1.0));
  // (0,0,0) + (0,0,3); (10,0,0) + (0,1,0); half of (0,1,3) and half of (10-1,0,0).
  expect_near(placed(*scene), {{0, 0, 3}, {10, 1, 0}, {4.5, 0.5, 1.5}});
  const auto& normals = scene->meshes[0].primitives[0].normals;
  EXPECT_EQ(normals.at(0), Vec3f(0, 0, 1));
  EXPECT_EQ(normals.at(1), Vec3f(0, 1, 0));
  const json document = json::parse(scene->document);
  EXPECT_EQ(document["nodes"][3], json({{"mesh", 0}}));
  EXPECT_EQ(document["meshes"].size(), 1U);
  EXPECT_FALSE(says(*scene, "weights of", ""));
}

TEST(ImportSkins, AMeshThatOthersDrawIsCopiedAndTheOthersKeepIt) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const std::string joints = ",{\"translation\":[0,0,1]},{\"translation\":[0,0,2]},{\"translation\":[0,0,4]}";
  const std::string skins = "{\"joints\":[3,4]},{\"joints\":[3,5]}";
  const auto both =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0},{\"mesh\":0,\"skin\":1},{\"mesh\":0,\"skin\":1}" + joints, skins));
  ASSERT_TRUE(both) << describe(both);
  ASSERT_EQ(both->instances.size(), 3U);
  ASSERT_EQ(both->meshes.size(), 2U);
  expect_near(placed(*both, 0), {{0, 0, 1}, {1, 0, 2}, {0, 1, 1}});
  expect_near(placed(*both, 1), {{0, 0, 1}, {1, 0, 4}, {0, 1, 1}});
  expect_near(placed(*both, 2), {{0, 0, 1}, {1, 0, 4}, {0, 1, 1}});
  EXPECT_EQ(both->instances[1].mesh, both->instances[2].mesh);
  EXPECT_EQ(both->meshes[1].name, "m");
  const auto shared =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0},{\"mesh\":0,\"translation\":[0,9,0]},{}" + joints, skins));
  ASSERT_TRUE(shared) << describe(shared);
  ASSERT_EQ(shared->meshes.size(), 2U);
  expect_near(placed(*shared, 0), {{0, 9, 0}, {1, 9, 0}, {0, 10, 0}});
  expect_near(placed(*shared, 1), {{0, 0, 1}, {1, 0, 2}, {0, 1, 1}});
  EXPECT_EQ(json::parse(shared->document)["meshes"].size(), 2U);
}

// A mirror turns the surface inside out unless its triangles turn too; as an instance it is flagged instead.
TEST(ImportSkins, WhatIsMirroredKeepsItsOutside) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  t.attributes += ",\"NORMAL\":" + std::to_string(t.b.floats({1, 0, 1, 1, 0, 1, 1, 0, 1}, "VEC3", 3));
  const auto scene =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0},{\"scale\":[-1,1,1]},{\"scale\":[-2,1,1]}", "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = scene->meshes[0].primitives[0];
  expect_near(p.positions, {{0, 0, 0}, {-2, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(p.indices, (std::vector<std::uint32_t>{0, 2, 1}));
  EXPECT_NEAR(p.normals[0].x, -std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(p.normals[0].z, std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(p.normals[1].x, -1.0 / std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(p.normals[1].z, 2.0 / std::sqrt(5.0), 1e-6);
}

TEST(ImportSkins, FurtherSetsOfJointsCountAndQuantizedWeightsAreMadeToSumToOne) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  t.attributes += ",\"WEIGHTS_0\":" + std::to_string(t.b.array<std::uint8_t>({127, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0},
                                                                             5121, "VEC4", 4, ",\"normalized\":true"));
  t.attributes += ",\"JOINTS_1\":" +
                  std::to_string(t.b.array<std::uint16_t>({1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 5123, "VEC4", 4));
  t.attributes += ",\"WEIGHTS_1\":" + std::to_string(t.b.array<std::uint8_t>({127, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                                                             5121, "VEC4", 4, ",\"normalized\":true"));
  const auto scene = t.b.import(t.text("{\"mesh\":0,\"skin\":0},{},{\"translation\":[0,0,8]}", "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
  expect_near(placed(*scene), {{0, 0, 4}, {1, 0, 0}, {0, 1, 0}});
}

TEST(ImportSkins, WeightsThatMeanNothingAreCountedAndTheFirstJointStandsIn) {
  SkinnedTriangle t;
  t.joints({1, 0, 0, 0, 0, 7, 0, 0, 0, 1, 0, 0});
  t.weights({0, 0, 0, 0, 1, 5, 0, 0, -1, 1, std::nanf(""), 0});
  const auto scene = t.b.import(t.text("{\"mesh\":0,\"skin\":0},{},{\"translation\":[0,0,8]}", "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
  expect_near(placed(*scene), {{0, 0, 8}, {1, 0, 0}, {0, 1, 8}});
  EXPECT_TRUE(says(*scene, "weights of 3 vertices", "joints that it does not have"));
}

TEST(ImportSkins, APrimitiveWithoutWeightsIsNamedAsSuch) {
  SkinnedTriangle t;
  const std::string bare = t.attributes;
  t.joints({1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  t.attributes += "}},{\"attributes\":{" + bare;
  const auto scene = t.b.import(t.text("{\"mesh\":0,\"skin\":0},{},{\"translation\":[0,0,8]}", "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(says(*scene, "skin 0: 3 vertices", "have no JOINTS_0 and WEIGHTS_0"));
  EXPECT_FALSE(says(*scene, "weights of", ""));
}

/// Where such a vertex would go, nobody sees.
TEST(ImportSkins, VerticesThatNoTriangleNamesAreNotMoved) {
  SkinnedTriangle t;
  t.positions = t.b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 3e38F, 3e38F, 3e38F}, "VEC3", 3);
  t.attributes = "\"POSITION\":" + std::to_string(t.positions);
  t.joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  t.attributes += "},\"indices\":" + std::to_string(t.b.array<std::uint8_t>({0, 1, 2, 2, 1, 0}, 5121, "SCALAR", 1)) +
                  ",\"extras\":{";
  const auto scene =
      t.b.import(t.text("{\"mesh\":0,\"skin\":0},{},{\"scale\":[1e300,1e300,1e300]}", "{\"joints\":[1,2]}"));
  ASSERT_TRUE(scene) << describe(scene);
}

TEST(ImportSkins, WithoutWeightsOrJointsTheNodePlacesTheMesh) {
  SkinnedTriangle bare;
  const auto scene = bare.b.import(bare.text("{\"mesh\":0,\"skin\":0,\"translation\":[3,0,0]},{}", "{\"joints\":[1]}"));
  ASSERT_TRUE(scene) << describe(scene);
  expect_near(placed(*scene), {{3, 0, 0}, {4, 0, 0}, {3, 1, 0}});
  EXPECT_TRUE(says(*scene, "skin 0 of mesh 0", "the node places the mesh"));
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const auto empty = t.b.import(t.text("{\"mesh\":0,\"skin\":0,\"translation\":[3,0,0]},{}", "{\"joints\":[]}"));
  ASSERT_TRUE(empty) << describe(empty);
  expect_near(placed(*empty), {{3, 0, 0}, {4, 0, 0}, {3, 1, 0}});
  // A skin that nothing is drawn with.
  EXPECT_TRUE(says(t.b.import(t.text("{\"mesh\":0},{}", "{\"joints\":[1]}")).value(), "skin 0", "no mesh"));
}

TEST(ImportSkins, WhatIsHiddenStaysHidden) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const auto scene = t.b.import(t.text(
      "{\"children\":[1],\"extensions\":{\"KHR_node_visibility\":{\"visible\":false}}},{\"mesh\":0,\"skin\":0},{}",
      "{\"joints\":[2]}", "\"extensionsUsed\":[\"KHR_node_visibility\"],\"scenes\":[{\"nodes\":[0,2]}]"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_TRUE(scene->instances.empty());
  EXPECT_EQ(json::parse(scene->document)["nodes"][3]["extensions"]["KHR_node_visibility"]["visible"], false);
}

TEST(ImportSkins, BrokenSkinsAreRefusedByPlace) {
  SkinnedTriangle t;
  t.joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  t.weights({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const float inf = std::numeric_limits<float>::infinity();
  const int one = t.b.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
  const int broken = t.b.floats({inf, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16);
  const int three = t.b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1}, "MAT3", 9);
  struct Bad {
    std::string skin, place;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"{\"joints\":[1],\"inverseBindMatrices\":99}", "/skins/0/inverseBindMatrices"},
           {"{\"joints\":[1],\"inverseBindMatrices\":" + std::to_string(three) + "}", "/skins/0/inverseBindMatrices"},
           {"{\"joints\":[1,1],\"inverseBindMatrices\":" + std::to_string(one) + "}", "/skins/0/inverseBindMatrices"},
           {"{\"joints\":[1],\"inverseBindMatrices\":" + std::to_string(broken) + "}", "/skins/0/joints"},
           {"{\"joints\":[9]}", "/skins/0/joints/0"}}) {
    const auto scene = t.b.import(t.text("{\"mesh\":0,\"skin\":0},{}", bad.skin));
    ASSERT_FALSE(scene) << bad.skin;
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid);
    EXPECT_NE(scene.error().where.find(bad.place), std::string::npos) << describe(scene);
  }
  // A mesh of one triangle drawn with a thousand skins is not a thousand times as large as the file justifies.
  std::string nodes = "{}", skins;
  for (int s = 0; s < 300; ++s) {
    nodes += ",{\"mesh\":0,\"skin\":" + std::to_string(s) + "}";
    skins += (s == 0 ? "" : ",") + std::string("{\"joints\":[0]}");
  }
  EXPECT_TRUE(t.b.import(t.text(nodes, skins)));
}

}  // namespace
}  // namespace meshlode::testing
