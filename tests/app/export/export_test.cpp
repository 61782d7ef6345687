// SPDX-License-Identifier: GPL-3.0-or-later
// The exported geometry is the cut's: every triangle, its material, its attributes, vertices merged, nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/export/export.h"
#include "build_scene.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"

namespace meshlode::app {
namespace {

using test::Glb;

Glb export_cuts(const run::Asset& asset, const std::vector<std::vector<ClusterId>>& cuts) {
  return test::read_sound(export_glb(asset, cuts));
}

/// Equal up to what a float32 sum rounds (positions of about 1): the triangles come in the same order.
void expect_same_triangles(const std::vector<test::PlacedTriangle>& a, const std::vector<test::PlacedTriangle>& b) {
  ASSERT_EQ(a.size(), b.size());
  const auto rounded = [](std::vector<test::PlacedTriangle> triangles) {
    for (auto& t : triangles) {
      for (auto& p : t.corners) {
        for (double& c : p) c = static_cast<double>(static_cast<float>(c));
      }
      std::rotate(t.corners.begin(), std::min_element(t.corners.begin(), t.corners.end()), t.corners.end());
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
  };
  EXPECT_TRUE(rounded(a) == rounded(b));
}

TEST(Export, EveryUniformCutHasItsTrianglesAndMaterials) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  for (const double error : {-1.0, 0.001, 0.01, 0.1, 1e30}) {
    const auto cut = run::select_uniform(*asset, MeshId(0U), error).clusters;
    const Glb glb = export_cuts(*asset, {cut});
    expect_same_triangles(test::triangles_of(glb, 0), test::expected_triangles(*asset, MeshId(0U), cut));
  }
}

TEST(Export, VerticesAreMergedWhereAllTheirIntegersAgree) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto cuts = test::finest_cuts(*asset);
  const auto decoded = run::decode_all(*asset);
  ASSERT_TRUE(decoded.ok());
  std::set<std::pair<std::uint32_t, std::vector<std::int32_t>>> distinct;  // per material
  for (const ClusterId id : cuts[0]) {
    const run::DecodedCluster& c = (*decoded)[id.value];
    for (std::size_t t = 0; t < c.triangles.size(); ++t) {
      for (const std::uint8_t v : c.triangles[t]) {
        const auto first = c.channels.begin() + static_cast<std::ptrdiff_t>(std::size_t{v} * c.channel_count);
        distinct.insert({c.triangle_material[t], {first, first + static_cast<std::ptrdiff_t>(c.channel_count)}});
      }
    }
  }
  const Glb glb = export_cuts(*asset, cuts);
  std::size_t vertices = 0;
  for (const auto& primitive : glb.json["meshes"][0]["primitives"]) {
    vertices += glb.rows(primitive["attributes"]["POSITION"]).size();
  }
  EXPECT_EQ(vertices, distinct.size());
  EXPECT_EQ(glb.json["meshes"][0]["primitives"].size(), 3U) << "one primitive per material";
}

TEST(Export, NormalsAreUnitAndUvsAreTheSources) {
  const scene::Scene scene = test::make_rock_scene();
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const Glb glb = export_cuts(*asset, test::finest_cuts(*asset));
  const scene::Primitive& source = scene.meshes[0].primitives[0];
  for (const auto& primitive : glb.json["meshes"][0]["primitives"]) {
    const auto positions = glb.rows(primitive["attributes"]["POSITION"]);
    const auto normals = glb.rows(primitive["attributes"]["NORMAL"]);
    const auto uvs = glb.rows(primitive["attributes"]["TEXCOORD_0"]);
    for (std::size_t v = 0; v < positions.size(); v += 7) {
      const auto& n = normals[v];
      EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0, 1e-5);
      // Some source vertex at this place has this normal and these coordinates.
      bool is_found = false;
      for (std::size_t s = 0; s < source.positions.size() && !is_found; ++s) {
        const Vec3d d = source.positions[s] - Vec3d(positions[v][0], positions[v][1], positions[v][2]);
        const Vec3f e = source.normals[s] - Vec3f(Vec3d(n[0], n[1], n[2]));
        is_found = glm::dot(d, d) < 1e-6 && glm::dot(e, e) < 1e-4F &&
                   std::abs(static_cast<double>(source.uvs[0][s].x) - uvs[v][0]) < 1e-3 &&
                   std::abs(static_cast<double>(source.uvs[0][s].y) - uvs[v][1]) < 1e-3;
      }
      EXPECT_TRUE(is_found) << "vertex " << v;
    }
  }
}

TEST(Export, FlatMeshesHaveNoNormals) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_cube(4), "cube"));
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_EQ(asset->meshes()[0].normal_mode, format::NormalMode::kFlat);
  const Glb glb = export_cuts(*asset, test::finest_cuts(*asset));
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  EXPECT_FALSE(primitive["attributes"].contains("NORMAL"));
  EXPECT_FALSE(primitive.contains("material")) << "the default material is no material";
  EXPECT_FALSE(glb.json.contains("materials"));
  EXPECT_EQ(test::triangles_of(glb, 0).size(), 12U * 16U);
}

TEST(Export, ColorsComeBackAsTheirBytes) {
  scene::Primitive shape = lab::make_sphere(6);
  for (std::size_t i = 0; i < shape.positions.size(); ++i) {
    const float c = static_cast<float>(i % 256) / 255.0F;
    shape.colors.emplace_back(c, 1.0F - c, 0.25F, 1.0F);
  }
  const auto bytes = test::build_bytes(lab::as_scene(lab::as_mesh(std::move(shape))));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_EQ(asset->meshes()[0].has_color, 1U);
  const Glb glb = export_cuts(*asset, test::finest_cuts(*asset));
  const std::size_t accessor = glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
  EXPECT_EQ(glb.json["accessors"][accessor]["componentType"], 5121);
  EXPECT_EQ(glb.json["accessors"][accessor]["normalized"], true);
  for (const auto& c : glb.rows(accessor)) {
    EXPECT_NEAR(c[0] + c[1], 1.0, 1.0 / 255.0 + 1e-9);
    EXPECT_EQ(c[2], 64.0 / 255.0);
    EXPECT_EQ(c[3], 1.0);
  }
}

TEST(Export, KeptUvSetsStayUnderTheirNumberAndGapsAreZeros) {
  scene::Scene scene = test::make_rock_scene(8);
  for (scene::Primitive& primitive : scene.meshes[0].primitives) primitive.uvs[1] = std::move(primitive.uvs[0]);
  for (scene::Primitive& primitive : scene.meshes[0].primitives) primitive.uvs[0].clear();
  for (scene::SceneMaterial& material : scene.materials) material.uv_sets_used = 2;
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_EQ(asset->meshes()[0].uv_set_count, 1U);
  const Glb glb = export_cuts(*asset, test::finest_cuts(*asset));
  for (const auto& primitive : glb.json["meshes"][0]["primitives"]) {
    const auto zeros = glb.rows(primitive["attributes"]["TEXCOORD_0"]);
    EXPECT_TRUE(std::all_of(zeros.begin(), zeros.end(), [](const auto& uv) { return uv[0] == 0.0 && uv[1] == 0.0; }));
    const auto uvs = glb.rows(primitive["attributes"]["TEXCOORD_1"]);
    EXPECT_TRUE(std::any_of(uvs.begin(), uvs.end(), [](const auto& uv) { return uv[0] > 0.1; }));
  }
}

TEST(Export, BytesAreTheSameEveryTimeAndForAnyOrderOfTheCut) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  auto cuts = test::finest_cuts(*asset);
  const auto first = export_glb(*asset, cuts);
  std::reverse(cuts[0].begin(), cuts[0].end());
  const auto second = export_glb(*asset, cuts);
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_TRUE(*first == *second);
}

TEST(Export, CutsThatAreNotCutsAreRefused) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto refused = [&](const std::vector<std::vector<ClusterId>>& cuts) {
    const auto result = export_glb(*asset, cuts);
    return !result.ok() && result.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({{ClusterId(asset->clusters().size())}}));
  EXPECT_TRUE(refused({{ClusterId(0U), ClusterId(0U)}}));
  EXPECT_TRUE(refused({{ClusterId()}}));
}

TEST(Export, AnEmptyCutLeavesItsNodesWithoutAMesh) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const Glb glb = export_cuts(*asset, {{}});
  EXPECT_FALSE(glb.json.contains("meshes"));
  EXPECT_FALSE(glb.json["nodes"][1].contains("mesh"));
  EXPECT_EQ(glb.json["nodes"][1]["name"], "child");
  EXPECT_TRUE(glb.bin.empty());
}

}  // namespace
}  // namespace meshlode::app
