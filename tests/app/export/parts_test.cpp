// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes of an asset that are parts of one of the source are one mesh in the GLB, at the source's nodes.
#include <algorithm>

#include <gtest/gtest.h>

#include "app/export/choose_cuts.h"
#include "app/export/export.h"
#include "build_scene.h"
#include "builder/builder.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

using test::Glb;

/// A trunk with leaves and a rock, each twice. `offset`: of all positions.
run::Asset forest(const Vec3d& offset = Vec3d(0.0)) {
  scene::SourceMesh tree = lab::as_mesh(lab::make_rock(8));
  tree.name = "tree";
  tree.primitives.push_back(lab::make_foliage(300));
  for (std::uint32_t m = 0; m < 2; ++m) {
    tree.primitives[m].material = MaterialId(m);
    for (Vec3d& p : tree.primitives[m].positions) p += offset;
  }
  scene::Scene scene = lab::as_scene(std::move(tree));
  scene.materials.resize(2, scene.materials[0]);
  scene.meshes.push_back(lab::as_mesh(lab::make_rock(8)));
  scene.meshes[1].name = "rock";
  scene.instances.resize(4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    scene.instances[i].node = i;
    scene.instances[i].mesh = MeshId(i % 2);
    scene.instances[i].name = "node" + std::to_string(i);
  }
  builder::PipelineOptions options;
  options.aggregate = AggregateChoice::kAlways;
  options.error_tier = format::ErrorTier::kQem;
  builder::PipelineReport report;
  return run::Asset::from_vector(builder::build_lode(scene, options, {}, report).value()).value();
}

std::vector<test::PlacedTriangle> both(const run::Asset& asset, const std::vector<std::vector<ClusterId>>& cuts) {
  std::vector<test::PlacedTriangle> out = test::expected_triangles(asset, MeshId(0U), cuts[0]);
  for (const auto& triangle : test::expected_triangles(asset, MeshId(2U), cuts[2])) out.push_back(triangle);
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Parts, AreOneMeshAtTheNodesOfTheSource) {
  const run::Asset asset = forest();
  ASSERT_EQ(asset.meshes().size(), 3U);
  ASSERT_EQ(asset.instances().size(), 6U);
  const auto cuts = test::finest_cuts(asset);
  const Glb glb = test::read_sound(export_glb(asset, cuts));
  ASSERT_EQ(glb.json["meshes"].size(), 2U);
  EXPECT_EQ(glb.json["meshes"][0]["name"], "tree");
  EXPECT_EQ(glb.json["meshes"][1]["name"], "rock");
  ASSERT_EQ(glb.json["nodes"].size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(glb.json["nodes"][i]["mesh"], i % 2);
    EXPECT_EQ(glb.json["nodes"][i]["name"], "node" + std::to_string(i));
  }
  EXPECT_EQ(test::triangles_of(glb, 0), both(asset, cuts));
  auto leaves_alone = cuts;
  leaves_alone[0].clear();
  const Glb leaves = test::read_sound(export_glb(asset, leaves_alone));
  EXPECT_EQ(leaves.json["meshes"][0]["name"], "tree");
  EXPECT_EQ(test::triangles_of(leaves, 0), test::expected_triangles(asset, MeshId(2U), cuts[2]));
}

TEST(Parts, FarAwayStandInOneFrame) {
  const run::Asset asset = forest(Vec3d(3e7, 0.0, 0.0));
  const auto cuts = test::finest_cuts(asset);
  const Glb glb = test::read_sound(export_glb(asset, cuts));
  ASSERT_EQ(glb.json["nodes"].size(), 6U) << "a frame for each tree";
  const auto translation = glb.json["nodes"][4]["translation"].get<test::Point>();
  const auto found = test::triangles_of(glb, 0, translation), expected = both(asset, cuts);
  ASSERT_EQ(found.size(), expected.size());
  const double bearable = 1e-6 * asset.meshes()[0].diagonal;
  for (std::size_t t = 0; t < found.size(); ++t) {
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_NEAR(found[t].corners[k / 3][k % 3], expected[t].corners[k / 3][k % 3], bearable);
    }
  }
}

TEST(Parts, LevelsAreMeantUntilBothNextOnesAreGoodEnough) {
  const run::Asset asset = forest();
  std::vector<LodChain> chains(3);
  const auto chain = [&](std::uint32_t mesh, std::vector<double> coverage) {
    LodChain made;
    for (std::uint32_t level = 0; level < coverage.size(); ++level) {
      made.cuts.push_back(choose_level_cut(asset, MeshId(mesh), level).clusters);
    }
    made.screen_coverage = std::move(coverage);
    return made;
  };
  chains[0] = chain(0, {0.5, 0.1, 0.0});
  chains[1].cuts.emplace_back();
  chains[2] = chain(2, {0.3, 0.0});
  const Glb glb = test::read_sound(export_glb_lods(asset, chains));
  ASSERT_EQ(glb.json["meshes"].size(), 3U);
  EXPECT_EQ(glb.json["meshes"][2]["name"], "tree (level 2)");
  for (const std::size_t level : {0U, 1U, 2U}) {
    EXPECT_EQ(test::triangles_of(glb, level),
              both(asset, {chains[0].cuts[level], {}, chains[2].cuts[std::min<std::size_t>(level, 1)]}));
  }
  const double a = asset.meshes()[0].diagonal, b = asset.meshes()[2].diagonal, both_of = std::max(a, b);
  const auto coverage = glb.json["nodes"][0]["extras"]["MSFT_screencoverage"].get<std::vector<double>>();
  ASSERT_EQ(coverage.size(), 3U);
  EXPECT_NEAR(coverage[0], std::min({1.0, 0.5 * both_of / a, 0.3 * both_of / b}), 1e-12);
  EXPECT_NEAR(coverage[1], std::min(coverage[0], 0.1 * both_of / a), 1e-12);
  EXPECT_EQ(coverage[2], 0.0);
}

}  // namespace
}  // namespace meshlode::app
