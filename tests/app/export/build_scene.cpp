// SPDX-License-Identifier: GPL-3.0-or-later
#include "build_scene.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "builder/builder.h"
#include "format/grid.h"
#include "lab/samples/samples.h"
#include "run/decode/decode.h"

namespace meshlode::test {

std::vector<std::uint8_t> build_bytes(const scene::Scene& scene, double grid_step) {
  builder::PipelineOptions options;
  options.grid_step = grid_step;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, options, {}, report);
  if (bytes) return std::move(*bytes);
  ADD_FAILURE() << bytes.error().message();
  return {};
}

scene::Scene make_rock_scene(std::uint32_t n) {
  const scene::Primitive rock = lab::make_rock(n);
  scene::Scene scene;
  scene::SourceMesh& mesh = scene.meshes.emplace_back();
  mesh.name = "rock";
  const std::size_t third = rock.indices.size() / 9 * 3;
  for (std::size_t m = 0; m < 3; ++m) {
    scene::Primitive& primitive = mesh.primitives.emplace_back(rock);
    const auto first = rock.indices.begin() + static_cast<std::ptrdiff_t>(m * third);
    primitive.indices.assign(first, m == 2 ? rock.indices.end() : first + static_cast<std::ptrdiff_t>(third));
    primitive.material = MaterialId(m);
  }
  for (std::uint32_t m = 0; m < 3; ++m) {
    scene::SceneMaterial& material = scene.materials.emplace_back();
    material.source_index = m < 2 ? m : 0xFFFFFFFFU;
    material.uv_sets_used = 1;
  }
  scene.document = R"({"asset": {"version": "2.0", "copyright": "somebody"},
    "scene": 0, "scenes": [{"name": "all", "nodes": [0]}],
    "nodes": [{"name": "parent", "children": [1], "translation": [1, 2, 3]}, {"name": "child", "mesh": 0}],
    "meshes": [{"name": "rock", "extras": {"weight": 7}}],
    "materials": [{"name": "red"}, {"name": "green", "extensions": {"VENDOR_unknown": {"a": [1, 2]}}}]})";
  scene::SceneInstance& instance = scene.instances.emplace_back();
  instance.name = "child";
  instance.node = 1;
  instance.mesh = MeshId(0U);
  instance.transform[3] = {1.0, 2.0, 3.0, 1.0};
  return scene;
}

std::vector<PlacedTriangle> expected_triangles(const run::Asset& asset, MeshId mesh,
                                               const std::vector<ClusterId>& cut) {
  const auto decoded = run::decode_all(asset);
  EXPECT_TRUE(decoded.ok());
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  const format::PositionGrid grid{record.grid.log2, record.grid.mantissa};
  std::vector<PlacedTriangle> triangles;
  for (const ClusterId id : cut) {
    const run::DecodedCluster& cluster = (*decoded)[id.value];
    for (std::size_t t = 0; t < cluster.triangles.size(); ++t) {
      const std::uint32_t source = asset.materials()[cluster.triangle_material[t]].source_index;
      PlacedTriangle placed{source == format::kNone ? -1 : static_cast<int>(source), {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p = grid.decode(cluster.position(cluster.triangles[t][k]));
        placed.corners[k] = {record.origin[0] + p.x, record.origin[1] + p.y, record.origin[2] + p.z};
      }
      std::rotate(placed.corners.begin(), std::min_element(placed.corners.begin(), placed.corners.end()),
                  placed.corners.end());
      triangles.push_back(placed);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<std::vector<ClusterId>> finest_cuts(const run::Asset& asset) {
  std::vector<std::vector<ClusterId>> cuts;
  for (std::size_t m = 0; m < asset.meshes().size(); ++m) {
    cuts.push_back(run::select_uniform(asset, MeshId(m), -1.0).clusters);
  }
  return cuts;
}

}  // namespace meshlode::test
