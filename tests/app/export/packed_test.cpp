// SPDX-License-Identifier: GPL-3.0-or-later
// What --quantize and --meshopt write, read back by the importer: the cut's triangles, to the integer where 16 bits
// hold them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "app/export/export.h"
#include "build_scene.h"
#include "format/grid.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"
#include "scene/import/import.h"

namespace meshlode::app {
namespace {

constexpr std::array kPackings{Packing{true, false}, Packing{false, true}, Packing{true, true}};

/// A corner: position and texture coordinate in steps of the asset's own grids.
using Steps = std::array<long, 5>;
struct Corner {
  Steps steps{};
  Vec3f normal{0.0F};
};
using Triangle = std::pair<std::uint32_t, std::array<Corner, 3>>;  // material, corners from the least one on

void sort(std::vector<Triangle>& triangles) {
  const auto less = [](const Corner& a, const Corner& b) { return a.steps < b.steps; };
  for (auto& [material, corners] : triangles) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end(), less), corners.end());
  }
  const auto key = [](const Triangle& t) {
    return std::tuple(t.first, t.second[0].steps, t.second[1].steps, t.second[2].steps);
  };
  std::sort(triangles.begin(), triangles.end(), [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
}

std::vector<Triangle> triangles_of_cut(const run::Asset& asset, const std::vector<ClusterId>& cut) {
  const auto decoded = run::decode_all(asset);
  EXPECT_TRUE(decoded.ok());
  const format::MeshRecord& record = asset.meshes()[0];
  std::vector<Triangle> out;
  for (const ClusterId id : cut) {
    const run::DecodedCluster& cluster = (*decoded)[id.value];
    run::ClusterAttributes floats;
    run::decode_attributes(record, cluster, floats);
    for (std::size_t t = 0; t < cluster.triangles.size(); ++t) {
      Triangle& triangle = out.emplace_back(cluster.triangle_material[t], std::array<Corner, 3>{});
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint8_t v = cluster.triangles[t][k];
        Corner& corner = triangle.second[k];
        const Vec3i p = cluster.position(v);
        corner.steps = {p.x, p.y, p.z, 0, 0};
        if (!floats.normals.empty()) corner.normal = floats.normals[v];
        if (record.uv_set_count == 0) continue;
        const double step = format::exp2_exact(record.uv_log2[0]);
        for (int c = 0; c < 2; ++c)
          corner.steps[3 + static_cast<std::size_t>(c)] = std::lround(floats.uvs[0][v][c] / step);
      }
    }
  }
  sort(out);
  return out;
}

scene::Scene imported(const std::vector<std::uint8_t>& glb) {
  const std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / ("packed-" + name + ".glb");
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(glb.data()), static_cast<std::streamsize>(glb.size()));
  auto scene = scene::import_scene(path, {});
  std::filesystem::remove(path);
  EXPECT_TRUE(scene.ok()) << (scene ? "" : scene.error().message());
  return scene ? std::move(*scene) : scene::Scene();
}

/// What the importer makes of a GLB of one mesh, drawn once.
std::vector<Triangle> triangles_of_import(const std::vector<std::uint8_t>& glb, const format::MeshRecord& record,
                                          const Vec3d& moved) {
  const scene::Scene scene = imported(glb);
  std::vector<Triangle> out;
  EXPECT_EQ(scene.instances.size(), 1U);
  if (scene.instances.empty()) return out;
  const scene::SceneInstance& instance = scene.instances.front();
  const Vec3d origin(record.origin[0], record.origin[1], record.origin[2]);
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  for (const scene::Primitive& primitive : scene.meshes[instance.mesh.value].primitives) {
    for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
      Triangle& triangle = out.emplace_back(primitive.material.value, std::array<Corner, 3>{});
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = primitive.indices[i + k];
        Corner& corner = triangle.second[k];
        const Vec3d world(instance.transform * glm::dvec4(primitive.positions[v], 1.0));
        for (int c = 0; c < 3; ++c) {
          const double steps = (world - moved - origin)[c] / grid.step();
          corner.steps[static_cast<std::size_t>(c)] = std::lround(steps);
          EXPECT_NEAR(steps, std::round(steps), 1e-3);
        }
        if (!primitive.normals.empty()) corner.normal = primitive.normals[v];
        if (record.uv_set_count == 0) continue;
        const double step = format::exp2_exact(record.uv_log2[0]);
        for (int c = 0; c < 2; ++c)
          corner.steps[3 + static_cast<std::size_t>(c)] = std::lround(primitive.uvs[0][v][c] / step);
      }
    }
  }
  sort(out);
  return out;
}

/// `degrees`: that normals may be off.
void expect_same(const std::vector<Triangle>& expected, const std::vector<Triangle>& read, double degrees) {
  ASSERT_EQ(expected.size(), read.size());
  const double least = std::cos(degrees * 3.141592653589793 / 180.0);
  for (std::size_t t = 0; t < expected.size(); ++t) {
    ASSERT_EQ(expected[t].first, read[t].first) << t;
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner &a = expected[t].second[k], &b = read[t].second[k];
      ASSERT_EQ(a.steps, b.steps) << t;
      if (a.normal != Vec3f(0.0F)) {
        ASSERT_GE(glm::dot(glm::normalize(Vec3d(a.normal)), glm::normalize(Vec3d(b.normal))), least) << t;
      }
    }
  }
}

std::vector<std::uint8_t> packed(const run::Asset& asset, const std::vector<ClusterId>& cut, Packing packing) {
  const std::vector<std::vector<ClusterId>> cuts{cut};
  auto glb = export_glb(asset, cuts, packing);
  EXPECT_TRUE(glb.ok()) << (glb ? "" : glb.error().message());
  return glb ? std::move(*glb) : std::vector<std::uint8_t>();
}

nlohmann::json document_of(const std::vector<std::uint8_t>& glb) {
  const std::size_t length = glb[12] | std::size_t{glb[13]} << 8U | std::size_t{glb[14]} << 16U;
  return nlohmann::json::parse(glb.begin() + 20, glb.begin() + 20 + static_cast<std::ptrdiff_t>(length));
}

TEST(ExportPacked, TheImporterReadsTheCutsTrianglesToTheInteger) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const format::MeshRecord& record = asset->meshes()[0];
  ASSERT_EQ(record.uv_set_count, 1U);
  ASSERT_EQ(record.normal_mode, format::NormalMode::kStored);
  // As far as the asset's own code of normals reaches (MeshRecord::normal_scale), in each of the two that are compared.
  const double degrees = 2.0 * std::sqrt(2.0) / record.normal_scale * 180.0 / 3.141592653589793;
  for (const double error : {-1.0, 0.01, 1e30}) {
    const auto cut = run::select_uniform(*asset, MeshId(0U), error).clusters;
    const auto expected = triangles_of_cut(*asset, cut);
    const std::size_t plain = packed(*asset, cut, {}).size();
    for (const Packing packing : kPackings) {
      SCOPED_TRACE(std::to_string(error) + (packing.quantize ? " quantize" : "") + (packing.meshopt ? " meshopt" : ""));
      const auto glb = packed(*asset, cut, packing);
      expect_same(expected, triangles_of_import(glb, record, {1.0, 2.0, 3.0}), packing.quantize ? degrees : 0.01);
      // Of a few triangles the document is larger than what it describes.
      if (error < 0.0) {
        EXPECT_LT(glb.size(), plain);
      }
    }
  }
}

TEST(ExportPacked, ExtensionsAreRequiredWhereTheyAreUsed) {
  const auto bytes = test::build_bytes(test::make_rock_scene(6));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto cut = test::finest_cuts(*asset)[0];
  const auto required = [&](const std::vector<ClusterId>& clusters, Packing packing) {
    std::set<std::string> names;
    const nlohmann::json json = document_of(packed(*asset, clusters, packing));
    for (const auto& name : json.value("extensionsRequired", nlohmann::json::array())) names.insert(name);
    EXPECT_EQ(json.contains("buffers") ? json["buffers"].size() : 0U, clusters.empty()  ? 0U
                                                                      : packing.meshopt ? 2U
                                                                                        : 1U);
    return names;
  };
  using Names = std::set<std::string>;
  EXPECT_EQ(required(cut, {}), Names());
  EXPECT_EQ(required(cut, {true, false}), Names({"KHR_mesh_quantization"}));
  EXPECT_EQ(required(cut, {false, true}), Names({"EXT_meshopt_compression"}));
  EXPECT_EQ(required(cut, {true, true}), Names({"EXT_meshopt_compression", "KHR_mesh_quantization"}));
  EXPECT_EQ(required({}, {true, true}), Names()) << "nothing is drawn, nothing is stored";
}

TEST(ExportPacked, PositionsOfMoreThanSixteenBitsMoveByHalfAStepOfACoarserGrid) {
  const scene::Scene scene = test::make_rock_scene(8);
  const auto bytes = test::build_bytes(scene, 1.5e-5);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const format::MeshRecord& record = asset->meshes()[0];
  ASSERT_GT(record.bounds_max[0] - record.bounds_min[0], 1 << 16);
  const auto cut = test::finest_cuts(*asset)[0];
  for (const bool is_compressed : {false, true}) {
    const nlohmann::json json = document_of(packed(*asset, cut, {true, is_compressed}));
    const auto& node = json["nodes"].back();
    const double step = node["scale"][0], grid = format::PositionGrid{record.grid.log2, record.grid.mantissa}.step();
    EXPECT_EQ(std::exp2(std::round(std::log2(step / grid))), step / grid) << "a power of two";
    for (const auto& primitive : json["meshes"][0]["primitives"]) {
      const auto& accessor = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
      EXPECT_EQ(accessor["componentType"], 5123);
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_GE(accessor["min"][c].get<int>(), 0);
        EXPECT_LE(accessor["max"][c].get<int>(), 65535);
      }
    }
    EXPECT_GT(2.0 * (record.bounds_max[0] - record.bounds_min[0]) * grid / step, 65535.0)
        << "no coarser than it must be";
  }
  // Uncompressed, vertices keep their order: each moves by at most half a step along each axis.
  const scene::Scene exact = imported(packed(*asset, cut, {})), moved = imported(packed(*asset, cut, {true, false}));
  const double step = moved.instances.at(0).transform[0][0];
  ASSERT_EQ(exact.meshes[0].primitives.size(), moved.meshes[0].primitives.size());
  for (std::size_t m = 0; m < exact.meshes[0].primitives.size(); ++m) {
    const scene::Primitive &a = exact.meshes[0].primitives[m], &b = moved.meshes[0].primitives[m];
    ASSERT_EQ(a.indices, b.indices);
    for (std::size_t v = 0; v < a.positions.size(); ++v) {
      const Vec3d from(exact.instances.at(0).transform * glm::dvec4(a.positions[v], 1.0));
      const Vec3d to(moved.instances.at(0).transform * glm::dvec4(b.positions[v], 1.0));
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(from[c], to[c], 0.5 * step + 1e-6) << v;  // of the floats
    }
  }
}

/// n x n quads over [low, high], in x and z: hills that have one profile at x = 100.013, whatever their height.
scene::SourceMesh make_field(const char* name, std::uint32_t n, Vec2d low, Vec2d high, double height) {
  scene::Primitive field;
  field.material = MaterialId(0U);
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const Vec2d p = low + (high - low) * (Vec2d(x, y) / double(n));
      field.positions.emplace_back(p.x, height * std::sin(p.x - 100.013) + std::sin(p.y), p.y);
      const std::uint32_t v = y * (n + 1) + x;
      if (x < n && y < n) field.indices.insert(field.indices.end(), {v, v + n + 1, v + 1, v + 1, v + n + 1, v + n + 2});
    }
  }
  scene::SourceMesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(std::move(field));
  return mesh;
}

TEST(ExportPacked, MeshesOfOneGridFitTogetherAsTheyDid) {
  // The second one would fit 16 bits of the grid, the first one does not.
  scene::Scene scene;
  scene.meshes = {make_field("large", 40, {-199.987, 0.017}, {100.013, 60.017}, 20.0),
                  make_field("small", 40, {100.013, 0.017}, {130.013, 60.017}, 0.0)};
  for (std::uint32_t m = 0; m < 2; ++m) {
    scene.instances.emplace_back().mesh = MeshId(m);
    scene.instances.back().node = m;
  }
  scene.materials.emplace_back().source_index = 0xFFFFFFFFU;
  scene.document = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
    "nodes": [{"mesh": 0}, {"mesh": 1}], "meshes": [{"name": "large"}, {"name": "small"}]})";
  const auto bytes = test::build_bytes(scene, 1.0 / 1024.0);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  ASSERT_EQ(asset->meshes()[0].grid.log2, asset->meshes()[1].grid.log2);
  for (const Packing packing : {Packing{}, Packing{true, false}, Packing{true, true}}) {
    const auto glb = export_glb(*asset, test::finest_cuts(*asset), packing);
    ASSERT_TRUE(glb.ok());
    const scene::Scene read = imported(*glb);
    ASSERT_EQ(read.instances.size(), 2U);
    std::array<std::set<std::tuple<double, double, double>>, 2> points;
    for (const scene::SceneInstance& instance : read.instances) {
      for (const scene::Primitive& primitive : read.meshes[instance.mesh.value].primitives) {
        for (const auto& position : primitive.positions) {
          const Vec3d p(instance.transform * glm::dvec4(position, 1.0));
          if (std::abs(p.x - 100.013) < 0.1) points[instance.mesh.value].emplace(p.x, p.y, p.z);
        }
      }
    }
    EXPECT_EQ(points[0].size(), 41U);
    EXPECT_TRUE(points[0] == points[1]) << packing.quantize << packing.meshopt;
  }
}

TEST(ExportPacked, NormalsMoveByLittleWhereTheyAreCompressed) {
  const auto bytes = test::build_bytes(test::make_rock_scene());
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto cut = test::finest_cuts(*asset)[0];
  const auto glb = packed(*asset, cut, {true, true});
  expect_same(triangles_of_cut(*asset, cut), triangles_of_import(glb, asset->meshes()[0], {1.0, 2.0, 3.0}), 0.02);
}

TEST(ExportPacked, TextureCoordinatesBeyondTheUnitSquareStayFloats) {
  scene::Scene scene = test::make_rock_scene(8);
  for (scene::Primitive& primitive : scene.meshes[0].primitives) {
    for (Vec2f& uv : primitive.uvs[0]) uv = uv * 4.0F - 1.5F;
  }
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto cut = test::finest_cuts(*asset)[0];
  const auto expected = triangles_of_cut(*asset, cut);
  for (const Packing packing : kPackings) {
    const auto glb = packed(*asset, cut, packing);
    const nlohmann::json json = document_of(glb);
    std::set<int> components;
    for (const auto& accessor : json["accessors"]) {
      if (accessor["type"] == "VEC2") components.insert(accessor["componentType"].get<int>());
    }
    EXPECT_TRUE(components.contains(5126));
    expect_same(expected, triangles_of_import(glb, asset->meshes()[0], {1.0, 2.0, 3.0}), 1.0);
  }
}

TEST(ExportPacked, ChainsAndFarMeshesStandWhereTheyStood) {
  const scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_far_plane(16), "far"));
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto finest = test::finest_cuts(*asset)[0];
  const auto coarse = run::select_uniform(*asset, MeshId(0U), 1e30).clusters;
  for (const Packing packing : kPackings) {
    expect_same(triangles_of_cut(*asset, finest),
                triangles_of_import(packed(*asset, finest, packing), asset->meshes()[0], Vec3d(0.0)), 1.0);
    // A reader without MSFT_lod sees the finest level; the coarser one has the same frame.
    const std::vector<LodChain> chain{{{finest, coarse}, {0.5, 0.0}}};
    const auto glb = export_glb_lods(*asset, chain, packing);
    ASSERT_TRUE(glb.ok());
    expect_same(triangles_of_cut(*asset, finest), triangles_of_import(*glb, asset->meshes()[0], Vec3d(0.0)), 1.0);
    const nlohmann::json json = document_of(*glb);
    EXPECT_EQ(json["meshes"].size(), 2U);
    for (const auto& node : json["nodes"]) {
      if (node.contains("mesh")) {
        EXPECT_FALSE(node.contains("scale")) << "levels have no transform of their own";
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::app
