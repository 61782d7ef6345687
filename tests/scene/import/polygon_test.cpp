// SPDX-License-Identifier: GPL-3.0-or-later
// PLY, OBJ and STL: what is read, what is refused, and that nothing is lost quietly.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <tuple>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

using Corners = std::vector<std::uint32_t>;

class ImportPolygons : public ::testing::Test {
 protected:
  Result<scene::Scene> read(const std::string& name, const std::string& bytes,
                            const scene::ImportOptions& options = {}) {
    return scene::import_scene(folder_.write(name, bytes), options);
  }
  static const scene::Primitive& primitive(const Result<scene::Scene>& scene) {
    return scene.value().meshes[0].primitives[0];
  }
  static void expect_invalid(const Result<scene::Scene>& scene, const std::string& place) {
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid) << describe(scene);
    EXPECT_NE(scene.error().where.find(place), std::string::npos) << describe(scene);
  }
  TempFolder folder_;
};

template <class T>
void put(std::string& bytes, T value, bool big_endian = false) {
  std::string raw(reinterpret_cast<const char*>(&value), sizeof(T));
  bytes += big_endian ? std::string(raw.rbegin(), raw.rend()) : raw;
}

const std::string kPlyHead =
    "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty double x\nproperty double y\n"
    "property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

TEST_F(ImportPolygons, PlyKeepsEveryDigitOfDoubles) {
  const auto scene = read("a.ply", kPlyHead + "1000000.0001 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).positions[0].x, 1000000.0001);
  EXPECT_EQ(primitive(scene).indices.size(), 6U);
  EXPECT_EQ(scene->meshes[0].name, "a");
  EXPECT_EQ(scene->materials.size(), 1U);
  ASSERT_EQ(scene->instances.size(), 1U);
  EXPECT_EQ(scene->instances[0].transform, Mat4d(1.0));
  EXPECT_EQ(scene->document, "{}");
}

TEST_F(ImportPolygons, PlyBinaryOfBothOrdersIsTheSameMesh) {
  for (const bool big : {false, true}) {
    std::string bytes = "ply\nformat " + std::string(big ? "binary_big_endian" : "binary_little_endian") +
                        " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "property short flavour\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "property float nx\nproperty float ny\nproperty float nz\n"
                        "element face 1\nproperty uchar kind\nproperty list ushort uint vertex_index\nend_header\n";
    for (int v = 0; v < 3; ++v) {
      put(bytes, v == 1 ? 2.5F : 0.0F, big);
      put(bytes, v == 2 ? 1.0F : 0.0F, big);
      put(bytes, -0.25F, big);
      put(bytes, std::int16_t{7}, big);
      for (const int c : {255, 0, 51}) put(bytes, static_cast<std::uint8_t>(c));
      for (const float n : {0.0F, 0.0F, 1.0F}) put(bytes, n, big);
    }
    put(bytes, std::uint8_t{9});
    put(bytes, std::uint16_t{3}, big);
    for (const std::uint32_t i : {0U, 1U, 2U}) put(bytes, i, big);
    const auto scene = read("b.ply", bytes);
    ASSERT_TRUE(scene) << describe(scene);
    const scene::Primitive& p = primitive(scene);
    EXPECT_EQ(p.indices, (Corners{0, 1, 2}));
    EXPECT_EQ(p.positions[1], Vec3d(2.5, 0, -0.25));
    ASSERT_EQ(p.colors.size(), 3U);
    EXPECT_FLOAT_EQ(p.colors[0].z, 0.033104766F);  // level 51 of sRGB
    EXPECT_FLOAT_EQ(p.colors[0].w, 1.0F);
    EXPECT_EQ(p.normals[2], Vec3f(0, 0, 1));
    ASSERT_EQ(scene->left_out.size(), 2U);
    EXPECT_EQ(scene->left_out[0].what, "vertex property flavour");
    EXPECT_EQ(scene->left_out[1].what, "face property kind");
    EXPECT_EQ(scene->left_out[1].why, "it is not one that is kept: 1 face");
  }
}

TEST_F(ImportPolygons, PlyThatLiesAboutItsSizesIsRefusedAtOnce) {
  const auto start = std::chrono::steady_clock::now();
  const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string properties = "\nproperty float x\nproperty float y\nproperty float z\n";
  expect_invalid(read("a.ply", head + "2000000000" + properties + "end_header\n"), "element vertex");
  expect_invalid(read("a.ply", head + "-1" + properties + "end_header\n"), "header line");
  expect_invalid(read("a.ply", "ply\nformat ascii 1.0\nelement x 2000000000\nproperty int a\nend_header\n"),
                 "element x");
  std::string list = head + "1" + properties + "element face 1\nproperty list uint int vertex_indices\nend_header\n";
  list += std::string(12, '\0');
  put(list, std::uint32_t{4000000000U});
  expect_invalid(read("a.ply", list), "face 0");
  expect_invalid(read("a.ply", kPlyHead + "0 0 0 1 0 0 1 1 0 0 1 0 2000000000 1 2 3"), "face 0");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST_F(ImportPolygons, PlyFaultsAreNamedByTheirPlace) {
  expect_invalid(read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 zero\n4 0 1 2 3\n"), "vertex 3");
  expect_invalid(read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 nan\n4 0 1 2 3\n"), "vertex 3");
  expect_invalid(read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 4\n"), "face 0");
  expect_invalid(read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 -1\n"), "face 0");
  expect_invalid(read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2\n"), "face 0");
  const auto repaired = read("a.ply", kPlyHead + "0 0 0\n1 0 0\n1 1 0\n0 1 nan\n4 0 1 2 3\n", {.repair = true});
  ASSERT_TRUE(repaired) << describe(repaired);
  EXPECT_EQ(repaired->meshes[0].drops.repaired, 2U);
  EXPECT_TRUE(primitive(repaired).indices.empty());
}

TEST_F(ImportPolygons, ADentedQuadIsSplitAtItsDent) {
  // The dart (0,0) (2,0) is reflex at vertex 2 = (0.5,0.5): only the diagonal 2–0 lies inside.
  const auto scene = read("a.ply", kPlyHead + "0 2 0\n0 0 0\n2 0 0\n0.5 0.5 0\n4 0 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  ASSERT_EQ(p.indices.size(), 6U);
  double area = 0.0;
  for (std::size_t t = 0; t < 6; t += 3) {
    const Vec3d& a = p.positions[p.indices[t]];
    const Vec3d n = glm::cross(p.positions[p.indices[t + 1]] - a, p.positions[p.indices[t + 2]] - a);
    EXPECT_GT(n.z, 0.0);
    area += n.z / 2.0;
  }
  EXPECT_DOUBLE_EQ(area, 1.0);  // shoelace: the dart's own area
}

TEST_F(ImportPolygons, ComplexEdgesAndRepeatedFacesAreKept) {
  // Three faces on one edge and one of them twice: a half-edge mesh would refuse them.
  const auto scene =
      read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 5\n");
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).indices, (Corners{0, 1, 2, 0, 1, 3, 0, 1, 4, 0, 1, 4}));
}

TEST_F(ImportPolygons, ObjCornersBecomeWedges) {
  const auto scene = read("a.obj",
                          "mtllib ../../secret.mtl\n# two triangles, a seam along their edge\no thing\n"
                          "v 0 0 0\nv 1.00000000001 0 0\nv 1 1 0\nv 0 1 0\n"
                          "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.5 0\nvn 0 0 1\n"
                          "f 1/1/1 2/2/1 3/3/1\nf -4/4/-1 \\\n 3/3/1 4/1/1\n",
                          {.may_lack_images = true});
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  ASSERT_EQ(p.indices.size(), 6U);
  EXPECT_EQ(p.positions.size(), 5U);  // vertex 1 has two UVs, vertex 3 one
  EXPECT_EQ(p.positions[1].x, 1.00000000001);
  EXPECT_EQ(p.positions[p.indices[3]], p.positions[p.indices[0]]);
  EXPECT_NE(p.indices[3], p.indices[0]);
  EXPECT_EQ(p.indices[4], p.indices[2]);
  EXPECT_EQ(p.uvs[0][p.indices[0]], Vec2f(0, 1));
  EXPECT_EQ(p.uvs[0][p.indices[3]], Vec2f(0.5F, 0.5F));
  EXPECT_EQ(p.normals[p.indices[5]], Vec3f(0, 0, 1));
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_EQ(scene->left_out[0].what, "mtllib ../../secret.mtl");
}

TEST_F(ImportPolygons, ObjFaultsAreNamedByTheirLine) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_invalid(read("a.obj", vertices + "f 1 2 4\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f 1 2 0\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f 1 2 -4\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f 1/x 2 3\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f 1//99999999999999999999 2 3\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f /1 2 3\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "f 1 2 99999999999999999999\n"), "line 4");
  expect_invalid(read("a.obj", vertices + "v 1 2\n"), "line 4");
  expect_invalid(read("a.obj", "v 0 0 1e39\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "vertex 0");
  expect_invalid(read("a.obj", "v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "vertex 0");
  const auto repaired = read("a.obj", vertices + "v nan 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n", {.repair = true});
  ASSERT_TRUE(repaired) << describe(repaired);
  EXPECT_EQ(repaired->meshes[0].drops.repaired, 2U);
  EXPECT_EQ(primitive(repaired).indices, (Corners{0, 1, 2}));
}

TEST_F(ImportPolygons, ObjVertexColoursAreReadWhereEveryVertexHasOne) {
  const auto scene = read("a.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 2\nf 1 2 3\n");
  ASSERT_TRUE(scene) << describe(scene);
  ASSERT_EQ(primitive(scene).colors.size(), 3U);
  EXPECT_NEAR(primitive(scene).colors[0].y, 0.5F, 1e-5F);
  EXPECT_EQ(primitive(scene).colors[2].z, 1.0F);
}

TEST_F(ImportPolygons, ObjNumbersAreRoundedOnce) {
  // 1 + 2^-24 lies half way between two floats and goes to 1; a little more, which a double does not see, goes up.
  const std::string half = "1.000000059604644775390625";
  const auto scene = read("a.obj", "v 0 0 0 0.8 1 0\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nvt " + half + " " + half +
                                       "00000000000001\nvt +0.5 1e-50\nvt 4e38\nf 1/1 2/2 3/3\n");
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = primitive(scene);
  EXPECT_EQ(p.uvs[0][0], Vec2f(1.0F, 1.0F - std::nextafter(1.0F, 2.0F)));
  EXPECT_EQ(p.uvs[0][1], Vec2f(0.5F, 1.0F));
  EXPECT_EQ(p.uvs[0][2], Vec2f(0.0F, 1.0F));
  EXPECT_EQ(scene->left_out.at(0).why, "1 are not finite; zero stands in for them");
  EXPECT_EQ(p.colors[0], Vec4f(0.799999F, 1.0F, 0.0F, 1.0F));  // six digits, of which 999,999 is the last but 1
}

TEST_F(ImportPolygons, AVertexOfObjThatNoFaceHasDecidesNothing) {
  const auto scene = read("a.obj", "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 9 9 9 0 0 0\nv 0 1 0 1 1 1\nf 1 2 4\n");
  ASSERT_TRUE(scene) << describe(scene);
  for (const Vec4f& color : primitive(scene).colors) EXPECT_EQ(color, Vec4f(1.0F));
  EXPECT_EQ(primitive(scene).indices, (Corners{0, 1, 3}));
}

TEST_F(ImportPolygons, PlyColoursOfAnyTypeAreEightBits) {
  for (const auto& [type, value, level] : {std::tuple("uchar", "51", 51),
                                           {"ushort", "13107", 51},
                                           {"float", "0.2", 51},
                                           {"double", "0.201", 51},
                                           {"float", "2", 255},
                                           {"int", "-5", 0}}) {
    const std::string t = std::string("property ") + type + " ";
    const auto scene = read("a.ply",
                            "ply\nformat ascii 1.0\nelement vertex 3\n" + t + "red\n" + t + "green\n" + t +
                                "blue\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
                                "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 0\n" +
                                value + " 0 0 1 0 0\n0 0 0 0 1 0\n3 0 1 2\n",
                            {.linear_colors = true});
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(primitive(scene).colors[1], Vec4f(static_cast<float>(level) / 255.0F, 0.0F, 0.0F, 1.0F)) << type;
  }
}

std::string stl_text() {
  return "solid vertex of things\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n"
         " endloop\nendfacet\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 0 0\nVERTEX 1 1 0\nVERTEX 0 1 0\nENDLOOP\n"
         "ENDFACET\nendsolid\n";
}

std::string stl_binary(std::uint32_t stated, const std::vector<std::array<float, 9>>& facets) {
  std::string bytes = "solid but binary";
  bytes.resize(80, '\0');
  put(bytes, stated);
  for (const auto& facet : facets) {
    bytes.append(12, '\0');
    for (const float f : facet) put(bytes, f);
    bytes.append(2, '\0');
  }
  return bytes;
}

TEST_F(ImportPolygons, StlTextAndBinaryAreTheSameWeldedMesh) {
  const auto text = read("a.stl", stl_text());
  const auto binary = read("b.stl", stl_binary(2, {{0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 1, 0, 0, 1, 0}}));
  for (const auto* scene : {&text, &binary}) {
    ASSERT_TRUE(*scene) << describe(*scene);
    EXPECT_EQ(primitive(*scene).positions.size(), 4U);
    EXPECT_EQ(primitive(*scene).indices.size(), 6U);
    EXPECT_TRUE(primitive(*scene).normals.empty());
  }
}

TEST_F(ImportPolygons, StlCornersAreOneVertexWhereTheyAreEqualAndOnlyThere) {
  constexpr float kTiny = std::numeric_limits<float>::denorm_min();
  const float next = std::nextafter(1.0F, 2.0F);
  const auto scene =
      read("a.stl", stl_binary(2, {{0, 0, 0, 1, 0, 0, kTiny, 1, 0}, {-0.0F, 0, 0, next, 0, 0, 0, 1, 0}}));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(primitive(scene).indices, (Corners{0, 1, 2, 0, 3, 4}));
  EXPECT_EQ(primitive(scene).positions[2].x, static_cast<double>(kTiny));
}

TEST_F(ImportPolygons, StlFaultsAreRefusedAndNothingIsDroppedQuietly) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  expect_invalid(read("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"), "facet 0");
  expect_invalid(read("a.stl", "solid\nfacet\nouter loop\nvertex 0 0 x\n"), "facet 0");
  const std::vector<std::array<float, 9>> facets = {
      {kNan, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {1, 0, 0, 1, 0, 0, 0, 1, 0}};
  expect_invalid(read("a.stl", stl_binary(3, facets)), "facet 0");
  const auto repaired = read("a.stl", stl_binary(3, facets), {.repair = true});
  ASSERT_TRUE(repaired) << describe(repaired);
  EXPECT_EQ(repaired->meshes[0].drops.repaired, 1U);
  EXPECT_EQ(primitive(repaired).indices.size(), 3U);
  ASSERT_EQ(repaired->left_out.size(), 1U);
  EXPECT_EQ(repaired->left_out[0].what, "1 triangle");
}

TEST_F(ImportPolygons, ExtremeSizesSurvive) {
  for (const double scale : {1e-6, 1.0, 1e9}) {
    const std::string s = std::to_string(scale * 1e6) + "e-6";
    const auto scene =
        read("a.ply", kPlyHead + "0 0 0\n" + s + " 0 0\n" + s + " " + s + " 0\n0 " + s + " 0\n4 0 1 2 3\n");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_DOUBLE_EQ(primitive(scene).positions[2].y, scale);
  }
}

}  // namespace
}  // namespace meshlode::testing
