// SPDX-License-Identifier: GPL-3.0-or-later
// What accessors and primitives mean, on files small enough to know the answer.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "gltf_builder.h"

namespace meshlode::testing {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const scene::Primitive& only_primitive(const Result<scene::Scene>& scene) {
  return scene.value().meshes.at(0).primitives.at(0);
}

using Corners = std::vector<std::uint32_t>;

TEST(ImportGeometry, IndexedTrianglesOfEveryIndexTypeAreTheSame) {
  for (const int type : {5121, 5123, 5125}) {
    GltfBuilder b;
    const int p = b.floats(kSquare, "VEC3", 3);
    int i = 0;
    if (type == 5121) i = b.array<std::uint8_t>({0, 1, 2, 0, 2, 3}, type, "SCALAR", 1);
    if (type == 5123) i = b.array<std::uint16_t>({0, 1, 2, 0, 2, 3}, type, "SCALAR", 1);
    if (type == 5125) i = b.array<std::uint32_t>({0, 1, 2, 0, 2, 3}, type, "SCALAR", 1);
    const auto scene = b.import(mesh_text("\"POSITION\":" + std::to_string(p), ",\"indices\":" + std::to_string(i)));
    ASSERT_TRUE(scene) << describe(scene);
    const scene::Primitive& primitive = only_primitive(scene);
    EXPECT_EQ(primitive.indices, (Corners{0, 1, 2, 0, 2, 3}));
    ASSERT_EQ(primitive.positions.size(), 4U);
    EXPECT_EQ(primitive.positions[2], Vec3d(1, 1, 0));
    EXPECT_TRUE(primitive.normals.empty());
    EXPECT_EQ(scene->meshes[0].drops.repaired, 0U);
  }
}

TEST(ImportGeometry, StripsTurnEverySecondTriangleAndFansKeepTheirCentreLast) {
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3", 3);
  const auto strip = b.import(mesh_text("\"POSITION\":0", ",\"mode\":5"));
  ASSERT_TRUE(strip) << describe(strip);
  EXPECT_EQ(only_primitive(strip).indices, (Corners{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  const auto fan = b.import(mesh_text("\"POSITION\":0", ",\"mode\":6"));
  ASSERT_TRUE(fan) << describe(fan);
  EXPECT_EQ(only_primitive(fan).indices, (Corners{1, 2, 0, 2, 3, 0, 3, 4, 0}));
}

TEST(ImportGeometry, WithoutIndicesThreeVerticesAreATriangleAndTheRestIsReported) {
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
  const auto scene = b.import(mesh_text("\"POSITION\":0"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(only_primitive(scene).indices, (Corners{0, 1, 2}));
  ASSERT_EQ(scene->left_out.size(), 1U);
  EXPECT_NE(scene->left_out[0].why.find("last 1 corners"), std::string::npos);
}

TEST(ImportGeometry, PointsAndLinesAreLeftOutByName) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  for (const int mode : {0, 1, 2, 3}) {
    const auto scene = b.import(mesh_text("\"POSITION\":0", ",\"mode\":" + std::to_string(mode)));
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_TRUE(scene->meshes.at(0).primitives.empty());
    ASSERT_EQ(scene->left_out.size(), 1U);
    EXPECT_NE(scene->left_out[0].what.find("mesh 0 primitive 0"), std::string::npos);
  }
}

TEST(ImportGeometry, QuantizedPositionsFollowTheNormalizationRule) {
  // KHR_mesh_quantization: c / 127 clamped to -1 for signed, c / 255 for unsigned, the integer itself otherwise.
  struct Case {
    int component;
    std::string extra;
    double low, high;
  };
  const std::vector<Case> cases = {{5120, ",\"normalized\":true", -1.0, 1.0}, {5120, "", -128.0, 127.0},
                                   {5122, ",\"normalized\":true", -1.0, 1.0}, {5122, "", -32768.0, 32767.0},
                                   {5121, ",\"normalized\":true", 0.0, 1.0},  {5121, "", 0.0, 255.0},
                                   {5123, ",\"normalized\":true", 0.0, 1.0},  {5123, "", 0.0, 65535.0}};
  for (const Case& c : cases) {
    GltfBuilder b;
    int view = 0;
    if (c.component == 5120) view = b.view<std::int8_t>({-128, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0}, 4);
    if (c.component == 5121) view = b.view<std::uint8_t>({0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0}, 4);
    if (c.component == 5122) view = b.view<std::int16_t>({-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0}, 8);
    if (c.component == 5123) view = b.view<std::uint16_t>({0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0}, 8);
    b.accessor(view, c.component, 3, "VEC3", c.extra);
    const auto scene = b.import(mesh_text("\"POSITION\":0") + ",\"extensionsRequired\":[\"KHR_mesh_quantization\"]");
    ASSERT_TRUE(scene) << describe(scene);
    EXPECT_EQ(only_primitive(scene).positions[0], Vec3d(c.low, 0, 0)) << c.component << c.extra;
    EXPECT_EQ(only_primitive(scene).positions[1], Vec3d(c.high, 0, 0)) << c.component << c.extra;
  }
}

TEST(ImportGeometry, InterleavedAttributesAreReadByTheirStride) {
  GltfBuilder b;
  // position (12), normal (12), uv as two normalized bytes (2), padding (2)
  std::vector<std::uint8_t> bytes;
  const auto put = [&](float f) {
    const auto* p = reinterpret_cast<const std::uint8_t*>(&f);
    bytes.insert(bytes.end(), p, p + 4);
  };
  for (int v = 0; v < 3; ++v) {
    for (const float f : {static_cast<float>(v), static_cast<float>(v * v), 0.5F, 0.0F, 0.0F, 1.0F}) put(f);
    bytes.insert(bytes.end(), {static_cast<std::uint8_t>(51 * v), 255, 0, 0});
  }
  const int view = b.view(bytes, 28);
  b.accessor(view, 5126, 3, "VEC3");
  b.accessor(view, 5126, 3, "VEC3", ",\"byteOffset\":12");
  b.accessor(view, 5121, 3, "VEC2", ",\"byteOffset\":24,\"normalized\":true");
  const auto scene = b.import(mesh_text("\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_2\":2"));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = only_primitive(scene);
  EXPECT_EQ(p.positions[2], Vec3d(2, 4, 0.5));
  EXPECT_EQ(p.normals[1], Vec3f(0, 0, 1));
  ASSERT_EQ(p.uvs[2].size(), 3U);
  EXPECT_TRUE(p.uvs[0].empty());
  EXPECT_FLOAT_EQ(p.uvs[2][1].x, 0.2F);
  EXPECT_FLOAT_EQ(p.uvs[2][1].y, 1.0F);
}

TEST(ImportGeometry, SparseValuesReplaceTheBaseAndStandAloneWithoutOne) {
  for (const bool has_base : {true, false}) {
    GltfBuilder b;
    const int base = b.view(kSquare);
    const int indices = b.view<std::uint8_t>({1, 3});
    const int values = b.view<float>({5, 6, 7, 8, 9, 10});
    const std::string sparse = ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" + std::to_string(indices) +
                               ",\"componentType\":5121},\"values\":{\"bufferView\":" + std::to_string(values) + "}}";
    b.accessor(has_base ? base : -1, 5126, 4, "VEC3", sparse);
    b.array(kSquareIndices, 5123, "SCALAR", 1);
    const auto scene = b.import(mesh_text("\"POSITION\":0", ",\"indices\":1"));
    ASSERT_TRUE(scene) << describe(scene);
    const auto& p = only_primitive(scene).positions;
    EXPECT_EQ(p[0], Vec3d(0, 0, 0));
    EXPECT_EQ(p[1], Vec3d(5, 6, 7));
    EXPECT_EQ(p[2], has_base ? Vec3d(1, 1, 0) : Vec3d(0, 0, 0));
    EXPECT_EQ(p[3], Vec3d(8, 9, 10));
  }
}

TEST(ImportGeometry, ColoursOfEveryTypeAreLinearAndGetAlphaOne) {
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  b.array<float>({1, 0.5F, 0, 0, 0, 0, 2, -1, 0}, 5126, "VEC3", 3);
  b.accessor(b.view<std::uint16_t>({65535, 0, 0, 65535, 0, 0, 0, 0, 0, 0, 0, 0}), 5123, 3, "VEC4",
             ",\"normalized\":true");
  auto scene = b.import(mesh_text("\"POSITION\":0,\"COLOR_0\":1"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(only_primitive(scene).colors[0], Vec4f(1, 0.5F, 0, 1));
  EXPECT_EQ(only_primitive(scene).colors[2], Vec4f(1, 0, 0, 1));  // clamped
  scene = b.import(mesh_text("\"POSITION\":0,\"COLOR_0\":2"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(only_primitive(scene).colors[0], Vec4f(1, 0, 0, 1));
  EXPECT_EQ(only_primitive(scene).colors[1], Vec4f(0, 0, 0, 0));
}

TEST(ImportGeometry, BrokenNormalsAndUvsAreReplacedAndReported) {
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  b.floats({0, 0, 0, kNan, 0, 1, 0, 1, 0}, "VEC3", 3);
  b.floats({kNan, 0, 0.25F, 0.5F, 1, 1}, "VEC2", 2);
  const auto scene = b.import(mesh_text("\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2"));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = only_primitive(scene);
  EXPECT_EQ(p.normals[0], Vec3f(0, 0, 1));  // the triangle's own
  EXPECT_EQ(p.normals[1], Vec3f(0, 0, 1));
  EXPECT_EQ(p.normals[2], Vec3f(0, 1, 0));
  EXPECT_EQ(p.uvs[0][0], Vec2f(0, 0));
  EXPECT_EQ(p.uvs[0][1], Vec2f(0.25F, 0.5F));
  ASSERT_EQ(scene->left_out.size(), 2U);
  EXPECT_EQ(scene->left_out[0].what, "mesh 0 primitive 0 NORMAL");
}

TEST(ImportGeometry, RepairDropsExactlyTheTrianglesThatTouchWhatIsBroken) {
  GltfBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, kNan, 1, 0, 7, 7, 7}, "VEC3", 3);
  // triangle 1 touches the NaN, triangle 2 an index out of range; vertex 4 is unused.
  b.array<std::uint16_t>({0, 1, 2, 0, 2, 3, 0, 1, 99}, 5123, "SCALAR", 1);
  const std::string text = mesh_text("\"POSITION\":0", ",\"indices\":1");
  const auto refused = b.import(text);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalid);
  EXPECT_NE(refused.error().where.find("/meshes/0/primitives/0/indices"), std::string::npos) << describe(refused);
  const auto repaired = b.import(text, {.repair = true});
  ASSERT_TRUE(repaired) << describe(repaired);
  EXPECT_EQ(repaired->meshes[0].drops.repaired, 2U);
  EXPECT_EQ(only_primitive(repaired).indices, (Corners{0, 1, 2}));
  EXPECT_EQ(only_primitive(repaired).positions.size(), 3U);
}

TEST(ImportGeometry, NonFinitePositionsNameTheirAttribute) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    GltfBuilder b;
    b.floats({0, 0, 0, 1, 0, 0, 0, bad, 0}, "VEC3", 3);
    const auto scene = b.import(mesh_text("\"POSITION\":0"));
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, ErrorCode::kInvalid);
    EXPECT_NE(scene.error().where.find("/meshes/0/primitives/0/attributes/POSITION"), std::string::npos);
    EXPECT_NE(scene.error().detail.find("vertex 2"), std::string::npos);
  }
}

TEST(ImportGeometry, TheRestartValueIsNoIndexEvenWhereAVertexHasIt) {
  GltfBuilder b;
  std::vector<float> many(300 * 3, 0.0F);
  b.floats(many, "VEC3", 3);
  b.array<std::uint8_t>({0, 1, 255}, 5121, "SCALAR", 1);
  const auto scene = b.import(mesh_text("\"POSITION\":0", ",\"indices\":1"));
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().detail.find("restart"), std::string::npos) << describe(scene);
}

TEST(ImportGeometry, ASharedVertexBufferIsReadOnlyWhereItIsUsed) {
  // 1,000 vertices, two primitives of one triangle each: each stores three vertices, in their order.
  GltfBuilder b;
  std::vector<float> many;
  for (int v = 0; v < 1000; ++v) many.insert(many.end(), {static_cast<float>(v), 1, 2});
  b.floats(many, "VEC3", 3);
  b.array<std::uint16_t>({999, 0, 500}, 5123, "SCALAR", 1);
  const auto scene = b.import(mesh_text("\"POSITION\":0", ",\"indices\":1"));
  ASSERT_TRUE(scene) << describe(scene);
  const scene::Primitive& p = only_primitive(scene);
  ASSERT_EQ(p.positions.size(), 3U);
  EXPECT_EQ(p.indices, (Corners{2, 0, 1}));
  EXPECT_EQ(p.positions[2], Vec3d(999, 1, 2));
}

TEST(ImportGeometry, FarAwaySmallFeaturesKeepEveryBitOfTheirFloats) {
  GltfBuilder b;
  const std::vector<float> far = {1.0e6F, 0, 0, 1.0e6F + 0.0625F, 0, 0, 1.0e6F, 1.0e-3F, 0};
  b.floats(far, "VEC3", 3);
  const auto scene = b.import(mesh_text("\"POSITION\":0"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(only_primitive(scene).positions[1].x, 1000000.0625);
  EXPECT_EQ(only_primitive(scene).positions[2].y, static_cast<double>(1.0e-3F));
}

TEST(ImportGeometry, EmptyMeshesAndEmptyAccessorsAreNoError) {
  GltfBuilder b;
  const auto empty = b.import("\"meshes\":[{\"primitives\":[]}],\"nodes\":[{\"mesh\":0}]");
  ASSERT_TRUE(empty) << describe(empty);
  EXPECT_EQ(empty->instances.size(), 1U);
  b.accessor(-1, 5126, 0, "VEC3");
  const auto no_vertices = b.import(mesh_text("\"POSITION\":0"));
  ASSERT_TRUE(no_vertices) << describe(no_vertices);
  EXPECT_TRUE(only_primitive(no_vertices).indices.empty());
}

TEST(ImportGeometry, AccessorsWithoutAViewAreZero) {
  GltfBuilder b;
  b.accessor(-1, 5126, 3, "VEC3");
  const auto scene = b.import(mesh_text("\"POSITION\":0"));
  ASSERT_TRUE(scene) << describe(scene);
  EXPECT_EQ(only_primitive(scene).positions[2], Vec3d(0.0));
}

/// By the letter a stride is a multiple of 4 and at most 252; three.js wrote 6 and 2 for years.
TEST(ImportGeometry, AnyStrideThatTheElementFitsIsRead) {
  for (const std::size_t stride : {6U, 7U, 8U, 9U, 300U}) {
    std::vector<std::uint8_t> bytes(3 * stride - (stride - 6), 0);
    const std::int16_t corners[3][3] = {{0, 0, 0}, {300, 0, 0}, {0, -400, 5}};
    for (std::size_t v = 0; v < 3; ++v) std::memcpy(bytes.data() + v * stride, corners[v], 6);
    GltfBuilder b;
    b.view(bytes);
    b.views[0].insert(b.views[0].size() - 1, ",\"byteStride\":" + std::to_string(stride));
    b.accessor(0, 5122, 3, "VEC3");
    const auto scene = b.import(mesh_text("\"POSITION\":0"));
    ASSERT_TRUE(scene) << stride << ": " << describe(scene);
    EXPECT_EQ(only_primitive(scene).positions,
              (std::vector<Vec3d>{Vec3d(0, 0, 0), Vec3d(300, 0, 0), Vec3d(0, -400, 5)}));
  }
  GltfBuilder b;
  b.view<std::uint8_t>(std::vector<std::uint8_t>(18, 0));
  b.views[0].insert(b.views[0].size() - 1, ",\"byteStride\":5");
  b.accessor(0, 5122, 3, "VEC3");
  EXPECT_FALSE(b.import(mesh_text("\"POSITION\":0")));
}

/// Columns start at multiples of 4 bytes, and nothing need follow the last one's numbers.
TEST(ImportGeometry, TheLastColumnOfAMatrixNeedsNoPadding) {
  struct Matrix {
    const char* type;
    int component;
    std::size_t used;
  };
  for (const Matrix& matrix : {Matrix{"MAT2", 5121, 6}, Matrix{"MAT3", 5121, 11}, Matrix{"MAT3", 5123, 22}}) {
    for (const std::size_t missing : {0U, 1U}) {
      GltfBuilder b;
      b.view<std::uint8_t>(std::vector<std::uint8_t>(matrix.used - missing, 1));
      b.accessor(0, matrix.component, 1, matrix.type);
      EXPECT_EQ(static_cast<bool>(b.import("\"nodes\":[{}]")), missing == 0) << matrix.type << " " << missing;
    }
  }
}

/// The same file with chunks whose lengths leave their padding out, or that have none.
TEST(ImportGeometry, GlbChunksAreFoundWhereTheirLengthsOrTheirPaddingPutThem) {
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  const std::string good = b.glb(mesh_text("\"POSITION\":0"));
  std::uint32_t text_bytes = 0;
  std::memcpy(&text_bytes, good.data() + 12, 4);
  std::string text = good.substr(20, text_bytes);
  text.erase(text.find_last_of('}') + 1);
  const std::string rest = good.substr(20 + text_bytes);
  const TempFolder folder;
  for (std::size_t blanks = 0; blanks < 4; ++blanks) {
    for (std::size_t hidden = 0; hidden < 4; ++hidden) {
      const std::string padded = text + std::string(blanks, ' ');
      // Hidden padding: up to the next multiple of 4 and not counted.
      if (hidden != 0 && (padded.size() + hidden) % 4 != 0) continue;
      std::string glb = good.substr(0, 20) + padded + std::string(hidden, ' ') + rest;
      const auto length = static_cast<std::uint32_t>(glb.size()), size = static_cast<std::uint32_t>(padded.size());
      std::memcpy(glb.data() + 8, &length, 4);
      std::memcpy(glb.data() + 12, &size, 4);
      const auto scene = scene::import_scene(folder.write("scene.glb", glb), {});
      ASSERT_TRUE(scene) << blanks << " blanks, " << hidden << " hidden: " << describe(scene);
      EXPECT_EQ(only_primitive(scene).positions.size(), 3U);
    }
  }
}

/// After a restart value a strip begins anew, and with it which triangles turn; the same of fans.
TEST(ImportGeometry, StripsAndFansAreSplitAtRestartValuesWhereAnExtensionAllowsIt) {
  struct Case {
    int mode;
    std::vector<std::uint8_t> indices;
    Corners expected;
  };
  const std::vector<Case> cases = {
      {5, {0, 1, 2, 255, 3, 4, 5, 6}, {0, 1, 2, 3, 4, 5, 4, 6, 5}},
      {5, {255, 0, 1, 255, 255, 0, 1, 2, 3, 255}, {0, 1, 2, 1, 3, 2}},
      {6, {0, 1, 2, 3, 255, 4, 5, 6}, {1, 2, 0, 2, 3, 0, 5, 6, 4}},
  };
  for (const Case& each : cases) {
    GltfBuilder b;
    b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0, 0, 3, 0}, "VEC3", 3);
    b.array<std::uint8_t>(each.indices, 5121, "SCALAR", 1);
    const std::string text = mesh_text("\"POSITION\":0", ",\"indices\":1,\"mode\":" + std::to_string(each.mode));
    // What the corners are by their positions, for vertices that nothing names may not be stored.
    const auto corners_of = [](const scene::Scene& scene) {
      Corners out;
      const scene::Primitive& p = scene.meshes.at(0).primitives.at(0);
      for (const std::uint32_t i : p.indices) {
        out.push_back(static_cast<std::uint32_t>(p.positions[i].x + 2 * p.positions[i].y));
      }
      return out;
    };
    for (const char* extension : {"KHR_mesh_primitive_restart", "EXT_mesh_primitive_restart"}) {
      const std::string list = "[\"" + std::string(extension) + "\"]";
      const auto scene = b.import(text + ",\"extensionsUsed\":" + list + ",\"extensionsRequired\":" + list);
      ASSERT_TRUE(scene) << describe(scene);
      EXPECT_EQ(corners_of(*scene), each.expected);
      EXPECT_TRUE(scene->left_out.empty());
      EXPECT_EQ(scene->document.find("restart"), std::string::npos);  // an asset has none
    }
    const auto refused = b.import(text);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().detail.find("--repair gives the triangles"), std::string::npos) << describe(refused);
    const auto repaired = b.import(text, {.repair = true});
    ASSERT_TRUE(repaired) << describe(repaired);
    EXPECT_EQ(corners_of(*repaired).size(), each.expected.size());
    EXPECT_EQ(repaired->meshes[0].drops.repaired, 0U);
    ASSERT_EQ(repaired->left_out.size(), 1U);
    EXPECT_NE(repaired->left_out[0].why.find("restart values"), std::string::npos);
  }
  GltfBuilder b;
  b.floats(kSquare, "VEC3", 3);
  b.array<std::uint8_t>({0, 1, 2, 255, 1, 2}, 5121, "SCALAR", 1);
  EXPECT_FALSE(b.import(mesh_text("\"POSITION\":0", ",\"indices\":1") +
                        ",\"extensionsUsed\":[\"KHR_mesh_primitive_restart\"]"));  // not of lists
}

/// glTF has normalized whole numbers alone, and colours from 0 to 1.
TEST(ImportGeometry, ColoursThatAreTakenOtherwiseThanWrittenAreSaid) {
  const auto left_out_of = [](const Result<scene::Scene>& scene) {
    std::string out;
    for (const scene::LeftOut& each : scene.value().left_out) out += each.what + ": " + each.why + "\n";
    return out;
  };
  GltfBuilder bytes;
  bytes.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  bytes.array<std::uint8_t>({139, 0, 255, 0, 1, 0, 0, 0, 51, 255, 0, 0}, 5121, "VEC4", 4);
  bytes.array<std::uint8_t>({1, 0, 1, 1, 0, 1, 0, 1, 1, 1, 0, 1}, 5121, "VEC4", 4);
  bytes.array<std::uint16_t>({65535, 0, 13107, 0, 0, 0, 0, 0, 0}, 5123, "VEC3", 3);
  const auto whole = bytes.import(mesh_text("\"POSITION\":0,\"COLOR_0\":1"));
  ASSERT_TRUE(whole) << describe(whole);
  EXPECT_EQ(only_primitive(whole).colors.at(0), Vec4f(139.0F / 255.0F, 0, 1, 0));
  EXPECT_EQ(only_primitive(whole).colors.at(2), Vec4f(0.2F, 1, 0, 0));
  EXPECT_EQ(
      left_out_of(whole),
      "COLOR_0 of 3 vertices: whole numbers that are not said to be normalized; they are taken as if they were\n");
  // Zeros and ones mean what they say.
  const auto flags = bytes.import(mesh_text("\"POSITION\":0,\"COLOR_0\":2"));
  ASSERT_TRUE(flags) << describe(flags);
  EXPECT_EQ(only_primitive(flags).colors.at(1), Vec4f(0, 1, 0, 1));
  EXPECT_TRUE(flags->left_out.empty());
  const auto shorts = bytes.import(mesh_text("\"POSITION\":0,\"COLOR_0\":3"));
  ASSERT_TRUE(shorts) << describe(shorts);
  EXPECT_EQ(only_primitive(shorts).colors.at(0), Vec4f(1, 0, 0.2F, 1));

  GltfBuilder floats;
  floats.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  floats.floats({2, 0.5F, 0, 1, 0.5F, 0, 0.5F, -1, 0}, "VEC3", 3);
  const auto bright = floats.import(mesh_text("\"POSITION\":0,\"COLOR_0\":1"));
  ASSERT_TRUE(bright) << describe(bright);
  EXPECT_EQ(only_primitive(bright).colors.at(0), Vec4f(1, 0.5F, 0, 1));
  EXPECT_EQ(left_out_of(bright), "COLOR_0 of 2 vertices: values above 1 or below 0 are clamped to 0 … 1\n");
}

}  // namespace
}  // namespace meshlode::testing
