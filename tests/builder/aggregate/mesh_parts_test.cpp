// SPDX-License-Identifier: GPL-3.0-or-later
// Which parts become meshes, under which names and options, and what the asset says of them.
#include "builder/aggregate/mesh_parts.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/parallel.h"
#include "builder/builder.h"
#include "builder/write_meta.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

scene::SourceMesh tree(const std::string& name) {
  scene::SourceMesh mesh = lab::as_mesh(lab::make_rock(8));
  mesh.name = name;
  mesh.primitives.push_back(lab::make_foliage(260));
  mesh.primitives[1].material = MaterialId(1U);
  return mesh;
}

/// A tree, a rock, foliage, another tree of the same name, and one that has the name of the first one's leaves.
scene::Scene forest() {
  scene::Scene scene = lab::as_scene(tree("tree"));
  scene.materials.resize(2, scene.materials[0]);
  for (scene::SourceMesh& mesh : std::vector<scene::SourceMesh>{lab::as_mesh(lab::make_rock(8)),
                                                                lab::as_mesh(lab::make_foliage(260)), tree("tree")}) {
    scene.meshes.push_back(std::move(mesh));
  }
  scene.meshes[1].name = "tree#leaves";
  for (std::uint32_t i = 1; i < 4; ++i) scene.instances.push_back({"", i, MeshId(i)});
  return scene;
}

std::vector<AggregateDecision> decisions_of(const scene::Scene& scene) {
  std::vector<AggregateDecision> decisions;
  for (const scene::SourceMesh& mesh : scene.meshes) {
    decisions.push_back(decide_aggregate(mesh, {.choice = AggregateChoice::kAuto}));
  }
  return decisions;
}

TEST(MeshParts, HaveNamesAndOptionsOfTheirMesh) {
  const scene::Scene scene = forest();
  std::vector<AggregateDecision> decisions = decisions_of(scene);
  PipelineOptions options;
  options.mesh_options.resize(4);
  options.mesh_options[3].normal_error = 7.0;
  const std::vector<scene::MeshPart> parts = plan_parts(scene, decisions, options);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].of, 0U);
  EXPECT_EQ(parts[0].name, "tree#leaves2") << "a mesh has the other name";
  EXPECT_EQ(parts[0].most_triangles, (std::vector<std::uint32_t>{0, 512}));
  EXPECT_EQ(parts[1].of, 3U);
  EXPECT_EQ(parts[1].name, "tree#leaves3");
  ASSERT_EQ(options.mesh_options.size(), 6U);
  EXPECT_EQ(options.mesh_options[4].normal_error, MeshOptions().normal_error);
  EXPECT_EQ(options.mesh_options[5].normal_error, 7.0);
  ASSERT_EQ(decisions.size(), 6U);
  for (const std::size_t i : {0U, 1U, 3U}) EXPECT_FALSE(decisions[i].is_aggregate) << i;
  for (const std::size_t i : {2U, 4U, 5U}) {
    EXPECT_TRUE(decisions[i].is_aggregate) << i;
    EXPECT_TRUE(decisions[i].most_triangles.empty()) << i;
  }
  EXPECT_NE(decisions[4].reason.find("260 pieces"), std::string::npos);
  EXPECT_TRUE(decisions[0].reason.empty());
}

TEST(MeshParts, AreNoneWhereNothingIsAPart) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_foliage(260)));
  std::vector<AggregateDecision> decisions = decisions_of(scene);
  PipelineOptions options;
  EXPECT_TRUE(plan_parts(scene, decisions, options).empty());
  EXPECT_TRUE(decisions[0].is_aggregate);
  EXPECT_TRUE(options.mesh_options.empty());
}

std::vector<std::uint8_t> built(scene::Scene scene, bool is_given, std::size_t threads = 0) {
  PipelineOptions options;
  options.aggregate = AggregateChoice::kAuto;
  options.error_tier = format::ErrorTier::kQem;
  PipelineReport report;
  const auto build = [&] {
    return is_given ? build_lode(std::move(scene), options, {}, report) : build_lode(scene, options, {}, report);
  };
  auto bytes = threads == 0 ? build() : with_threads_at_most(threads, build);
  EXPECT_TRUE(bytes.ok()) << bytes.error().message();
  return bytes.ok() ? std::move(*bytes) : std::vector<std::uint8_t>();
}

TEST(MeshParts, AreTheSameForAnyThreadCountAndOwner) {
  const scene::Scene scene = forest();
  const std::vector<std::uint8_t> bytes = built(scene, false);
  EXPECT_EQ(scene.meshes.size(), 4U) << "the caller's scene stays as it is";
  EXPECT_EQ(built(scene, true), bytes);
  EXPECT_EQ(built(scene, false, 1), bytes);
}

TEST(MeshParts, AreSaidInMeta) {
  const scene::Scene scene = forest();
  const std::vector<scene::MeshPart> parts{{0, "a", {0, 512}}, {3, "b", {32}}};
  scene::Scene split = scene;
  scene::split_parts(split, parts);
  const auto meta = nlohmann::json::parse(meta_json(split, {}, {}, parts));
  EXPECT_EQ(meta.at("parts"), nlohmann::json::parse(R"([
    {"mesh": 4, "of": 0, "pieces": [{"material": 1, "triangles": 512}]},
    {"mesh": 5, "of": 3, "pieces": [{"material": 0, "triangles": 32}]}])"));
  EXPECT_FALSE(nlohmann::json::parse(meta_json(scene, {}, {})).contains("parts"));
}

}  // namespace
}  // namespace meshlode::builder
