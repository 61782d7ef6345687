// SPDX-License-Identifier: GPL-3.0-or-later
// Far-away meshes keep their features: the origin goes into a node where floats cannot hold both.
#include <gtest/gtest.h>

#include <cmath>

#include "app/export/export.h"
#include "build_scene.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

using test::Glb;

Glb export_finest(const run::Asset& asset) {
  return test::read_sound(export_glb(asset, test::finest_cuts(asset)));
}

TEST(ExportFar, AMeshAMillionUnitsAwayKeepsItsFeaturesThroughAChildNode) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_far_plane(16), "far"));
  scene.document = R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"name": "holder", "mesh": 0, "rotation": [0, 1, 0, 0], "children": [1]}, {"name": "other"}],
    "meshes": [{"name": "far"}]})";
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const Glb glb = export_finest(*asset);
  ASSERT_EQ(glb.json["nodes"].size(), 3U);
  const auto& holder = glb.json["nodes"][0];
  EXPECT_FALSE(holder.contains("mesh"));
  EXPECT_EQ(holder["rotation"], nlohmann::json::array({0, 1, 0, 0})) << "its own transform stays";
  EXPECT_EQ(holder["children"], nlohmann::json::array({1, 2}));
  const auto& child = glb.json["nodes"][2];
  EXPECT_EQ(child["mesh"], 0);
  const test::Point translation{child["translation"][0], child["translation"][1], child["translation"][2]};
  // With the node's translation the triangles are the cut's, to the last bit of the double sums.
  const auto exported = test::triangles_of(glb, 0, translation);
  const auto expected = test::expected_triangles(*asset, MeshId(0U), test::finest_cuts(*asset)[0]);
  ASSERT_EQ(exported.size(), expected.size());
  for (std::size_t i = 0; i < exported.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(exported[i].corners[k][c], expected[i].corners[k][c]);
    }
  }
}

TEST(ExportFar, AMeshNearItsOriginIsNotMoved) {
  for (const double factor : {1e-6, 1.0, 1e9}) {
    scene::Scene scene = lab::as_scene(lab::as_mesh(lab::scaled(lab::make_rock(6), factor), "near"));
    const auto bytes = test::build_bytes(scene);
    const auto asset = run::Asset::from_bytes(bytes);
    ASSERT_TRUE(asset.ok());
    const Glb glb = export_finest(*asset);
    ASSERT_EQ(glb.json["nodes"].size(), 1U) << factor;
    EXPECT_EQ(glb.json["nodes"][0]["mesh"], 0);
    EXPECT_FALSE(glb.json["nodes"][0].contains("translation"));
    const auto exported = test::triangles_of(glb, 0);
    const auto expected = test::expected_triangles(*asset, MeshId(0U), test::finest_cuts(*asset)[0]);
    ASSERT_EQ(exported.size(), expected.size());
    const double bearable = asset->meshes()[0].diagonal * 0x1p-20;
    for (std::size_t i = 0; i < exported.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(exported[i].corners[0][c], expected[i].corners[0][c], bearable);
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::app
