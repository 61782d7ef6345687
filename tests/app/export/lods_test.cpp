// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle budgets and discrete chains: the budget holds and could not be spent better, and each level of an MSFT_lod
// chain is its cut, in a frame where no reader can misplace it.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/export/choose_cuts.h"
#include "app/export/export.h"
#include "build_scene.h"
#include "lab/samples/samples.h"

namespace meshlode::app {
namespace {

using nlohmann::json;
using test::Glb;

/// Of mesh 0, decoded.
std::uint64_t triangles_of(const run::Asset& asset, const std::vector<ClusterId>& cut) {
  return test::expected_triangles(asset, MeshId(0U), cut).size();
}

/// A chain of three levels for the one mesh of the asset.
LodChain make_chain(const run::Asset& asset, std::vector<double> coverage = {0.5, 0.1, 0.0}) {
  const std::uint32_t levels = asset.meshes()[0].level_count;
  EXPECT_GT(levels, 2U);
  LodChain chain;
  for (const std::uint32_t level : {0U, 1U, levels}) {
    chain.cuts.push_back(choose_level_cut(asset, MeshId(0U), level).clusters);
  }
  chain.screen_coverage = std::move(coverage);
  return chain;
}

Glb export_chain(const run::Asset& asset, const LodChain& chain) {
  return test::read_sound(export_glb_lods(asset, {&chain, 1}));
}

TEST(Budget, IsTheFinestUniformCutThatFits) {
  const auto bytes = test::build_bytes(lab::as_scene(lab::as_mesh(lab::make_sphere(24))));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  // All uniform cuts there are, by the other way to make them.
  std::vector<double> errors = {-1.0};
  for (const format::GroupRecord& group : asset->groups()) errors.push_back(static_cast<double>(group.error));
  std::vector<std::uint64_t> counts;
  for (const double error : errors) {
    counts.push_back(triangles_of(*asset, run::select_uniform(*asset, MeshId(0U), error).clusters));
  }
  const double unit = 1.0;
  for (std::uint64_t budget = 0; budget < counts[0] + 100; budget += 37) {
    const BudgetCuts cuts = choose_budget_cuts(*asset, {&unit, 1}, budget);
    std::uint64_t best = 0;
    for (const std::uint64_t count : counts) best = count <= budget ? std::max(best, count) : best;
    EXPECT_EQ(cuts.is_met, best > 0) << budget;
    EXPECT_EQ(cuts.triangles, cuts.is_met ? best : *std::min_element(counts.begin(), counts.end())) << budget;
    EXPECT_EQ(triangles_of(*asset, cuts.cuts[0].clusters), cuts.triangles);
    if (cuts.is_met) {
      EXPECT_EQ(cuts.cuts[0].clusters, run::select_uniform(*asset, MeshId(0U), cuts.threshold).clusters);
    }
  }
}

TEST(Budget, OneThresholdInEachMeshsOwnUnit) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_sphere(24)));
  scene::SourceMesh large = scene.meshes[0];
  for (Vec3d& p : large.primitives[0].positions) p *= 1024.0;
  scene.meshes.push_back(large);
  scene::SceneInstance instance = scene.instances[0];
  instance.mesh = MeshId(1U);
  scene.instances.push_back(instance);
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const std::vector<double> relative = {asset->meshes()[0].diagonal, asset->meshes()[1].diagonal};
  const BudgetCuts even = choose_budget_cuts(*asset, relative, 1500);
  ASSERT_TRUE(even.is_met);
  EXPECT_LE(even.triangles, 1500U);
  EXPECT_EQ(even.cuts[0].clusters.size(), even.cuts[1].clusters.size()) << "the same shape at the same relative error";
  const BudgetCuts absolute = choose_budget_cuts(*asset, std::vector<double>{1.0, 1.0}, 1500);
  ASSERT_TRUE(absolute.is_met);
  EXPECT_LT(absolute.cuts[0].clusters.size(), absolute.cuts[1].clusters.size()) << "a unit is little to the large one";
  const BudgetCuts second = choose_budget_cuts(*asset, std::vector<double>{0.0, 1.0}, 500);
  EXPECT_TRUE(second.cuts[0].clusters.empty()) << "left out";
  EXPECT_LE(second.triangles, 500U);
}

TEST(Lods, EachLevelIsItsCut) {
  const auto bytes = test::build_bytes(test::make_rock_scene(16));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const LodChain chain = make_chain(*asset);
  const Glb glb = export_chain(*asset, chain);
  ASSERT_EQ(glb.json["meshes"].size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(test::triangles_of(glb, k).size(), triangles_of(*asset, chain.cuts[k])) << "level " << k;
    EXPECT_EQ(glb.json["meshes"][k]["extras"]["weight"], 7);
  }
  const auto& nodes = glb.json["nodes"];
  ASSERT_TRUE(nodes[1].contains("extensions")) << "the node itself: it has neither transform nor children";
  EXPECT_EQ(nodes[1]["mesh"], 0);
  EXPECT_EQ(nodes[1]["extras"]["MSFT_screencoverage"], json({0.5, 0.1, 0.0}));
  const auto ids = nodes[1]["extensions"]["MSFT_lod"]["ids"];
  ASSERT_EQ(ids.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t id = ids[k];
    EXPECT_EQ(nodes[id]["mesh"], k + 1);
    for (const char* key : {"matrix", "translation", "rotation", "scale", "children"}) {
      EXPECT_FALSE(nodes[id].contains(key));
    }
    for (const auto& node : nodes) {
      if (!node.contains("children")) continue;
      EXPECT_EQ(std::count(node["children"].begin(), node["children"].end(), id), 0) << "drawn twice";
    }
  }
  const auto& used = glb.json["extensionsUsed"];
  EXPECT_EQ(std::count(used.begin(), used.end(), "MSFT_lod"), 1);
  EXPECT_FALSE(glb.json.contains("extensionsRequired")) << "a reader without it draws the finest level";
}

TEST(Lods, ANodeThatIsMovedOrHasChildrenGetsAFrameForItsLevels) {
  scene::Scene scene = test::make_rock_scene(16);
  json document = json::parse(scene.document);
  document["nodes"][1]["scale"] = {2, 2, 2};
  document["nodes"][1]["extras"] = "kept";
  scene.document = document.dump();
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const Glb glb = export_chain(*asset, make_chain(*asset));
  const auto& nodes = glb.json["nodes"];
  EXPECT_FALSE(nodes[1].contains("mesh"));
  EXPECT_FALSE(nodes[1].contains("extensions"));
  EXPECT_EQ(nodes[1]["extras"], "kept");
  ASSERT_EQ(nodes[1]["children"].size(), 1U);
  const json& holder = nodes[nodes[1]["children"][0].get<std::size_t>()];
  EXPECT_EQ(holder["mesh"], 0);
  EXPECT_FALSE(holder.contains("scale"));
  EXPECT_EQ(holder["extensions"]["MSFT_lod"]["ids"].size(), 2U);
}

TEST(Lods, AllLevelsOfAFarAwayMeshShareItsOrigin) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_sphere(24)));
  for (Vec3d& p : scene.meshes[0].primitives[0].positions) p += Vec3d(1e6, 0.0, 0.0);
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const Glb glb = export_chain(*asset, make_chain(*asset));
  std::size_t with_translation = 0;
  for (const auto& node : glb.json["nodes"]) {
    if (!node.contains("translation")) continue;
    ++with_translation;
    EXPECT_FALSE(node.contains("mesh"));
    EXPECT_NEAR(node["translation"][0].get<double>(), 1e6, 1.0);
  }
  EXPECT_EQ(with_translation, 1U);
}

TEST(Lods, ChainsThatAreNoneAreRefused) {
  const auto bytes = test::build_bytes(test::make_rock_scene(16));
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  const auto refused = [&](const LodChain& chain) {
    const auto result = export_glb_lods(*asset, {&chain, 1});
    return !result.ok() && result.error().code == ErrorCode::kUsage;
  };
  EXPECT_FALSE(refused(make_chain(*asset)));
  EXPECT_FALSE(refused(make_chain(*asset, {})));
  EXPECT_TRUE(refused(make_chain(*asset, {0.5, 0.1}))) << "one value per level";
  EXPECT_TRUE(refused(make_chain(*asset, {0.1, 0.5, 0.0}))) << "rising";
  EXPECT_TRUE(refused(make_chain(*asset, {1.5, 0.5, 0.0})));
  LodChain gap = make_chain(*asset);
  gap.cuts[1].clear();
  EXPECT_TRUE(refused(gap));
}

TEST(Lods, ImagesOfOtherTypesAreNamedByTheirExtension) {
  scene::Scene scene = test::make_rock_scene(6);
  json document = json::parse(scene.document);
  document["images"] = json::parse(R"([{"blob": 0}, {"blob": 1}])");
  document["textures"] = json::parse(R"([{"source": 0}, {"source": 1}])");
  scene.document = document.dump();
  scene.blobs = {
      {scene::SceneBlob::Kind::kImage, "a.ktx2", "image/ktx2", 0, {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB}},
      {scene::SceneBlob::Kind::kImage, "b.png", "image/png", 1, {0x89, 'P', 'N', 'G'}}};
  const auto bytes = test::build_bytes(scene);
  const auto asset = run::Asset::from_bytes(bytes);
  ASSERT_TRUE(asset.ok());
  LodChain chain;
  chain.cuts = {test::finest_cuts(*asset)[0]};
  const Glb glb = export_chain(*asset, chain);
  EXPECT_EQ(glb.json["textures"][0], json::parse(R"({"extensions": {"KHR_texture_basisu": {"source": 0}}})"));
  EXPECT_EQ(glb.json["textures"][1], json::parse(R"({"source": 1})"));
  EXPECT_EQ(glb.json["extensionsRequired"], json({"KHR_texture_basisu"}));
}

}  // namespace
}  // namespace meshlode::app
