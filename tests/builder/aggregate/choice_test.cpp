// SPDX-License-Identifier: GPL-3.0-or-later
// Which meshes are aggregates, and what their coarse materials are.
#include <cmath>

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/aggregate/coarse_materials.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

bool is_aggregate(scene::Primitive shape, AggregateChoice choice = AggregateChoice::kAuto) {
  return decide_aggregate(lab::as_mesh(std::move(shape)), {.choice = choice}).is_aggregate;
}

TEST(AggregateChoice, IsOfManySmallLoosePieces) {
  EXPECT_TRUE(is_aggregate(lab::make_grass(2000)));
  EXPECT_TRUE(is_aggregate(lab::make_foliage(2000)));
  EXPECT_TRUE(is_aggregate(lab::make_box_soup(400)));
  EXPECT_FALSE(is_aggregate(lab::make_grass(100))) << "few";
  EXPECT_FALSE(is_aggregate(lab::make_rock(16))) << "one";
  EXPECT_FALSE(is_aggregate(lab::make_sphere(32)));
  EXPECT_FALSE(is_aggregate(lab::make_grass(2000), AggregateChoice::kNever));
  EXPECT_TRUE(is_aggregate(lab::make_grass(100), AggregateChoice::kAlways));
  const AggregateDecision large =
      decide_aggregate(lab::as_mesh(lab::make_sphere(32)), {.choice = AggregateChoice::kAlways});
  EXPECT_FALSE(large.is_aggregate);
  EXPECT_NE(large.reason.find("12288 triangles"), std::string::npos) << large.reason;
  EXPECT_FALSE(decide_aggregate(scene::SourceMesh{}, {.choice = AggregateChoice::kAlways}).is_aggregate);
  EXPECT_FALSE(
      decide_aggregate(lab::as_mesh(lab::make_grass(2000)), {.choice = AggregateChoice::kAlways, .keep_topology = true})
          .is_aggregate);
  EXPECT_FALSE(
      decide_aggregate(lab::as_mesh(lab::make_grass(2000)), {.choice = AggregateChoice::kAlways, .lock_borders = true})
          .is_aggregate);
}

/// Primitives with materials 0, 1, 2 …
scene::SourceMesh mesh_of(std::vector<scene::Primitive> parts, const std::string& name = "tree") {
  scene::SourceMesh mesh;
  mesh.name = name;
  for (std::uint32_t m = 0; m < parts.size(); ++m) {
    parts[m].material = MaterialId(m);
    mesh.primitives.push_back(std::move(parts[m]));
  }
  return mesh;
}

using Most = std::vector<std::uint32_t>;

TEST(AggregateParts, LeavesOfATreeAreOneAndItsTrunkIsNot) {
  const scene::SourceMesh tree = mesh_of({lab::make_rock(16), lab::make_foliage(2000)});
  const AggregateDecision parts = decide_aggregate(tree, {.choice = AggregateChoice::kAuto});
  EXPECT_TRUE(parts.is_aggregate);
  EXPECT_EQ(parts.most_triangles, (Most{0, 512}));
  EXPECT_NE(parts.reason.find("2000 pieces"), std::string::npos) << parts.reason;
  std::vector<std::uint8_t> is_used(2, 0);
  add_materials(tree, parts, is_used);
  EXPECT_EQ(is_used, (std::vector<std::uint8_t>{0, 1}));
  const AggregateDecision all = decide_aggregate(tree, {.choice = AggregateChoice::kAlways});
  EXPECT_EQ(all.most_triangles, (Most{0, 512}));
  EXPECT_TRUE(
      decide_aggregate(mesh_of({lab::make_grass(2000), lab::make_foliage(2000)}), {.choice = AggregateChoice::kAuto})
          .most_triangles.empty())
      << "all of it";
  EXPECT_FALSE(
      decide_aggregate(mesh_of({lab::make_rock(16), lab::make_foliage(200)}), {.choice = AggregateChoice::kAuto})
          .is_aggregate)
      << "few";
}

TEST(AggregateParts, OfOneMaterialSmallPiecesAreOneIfTheyAreMostOfIt) {
  const auto both = [](std::uint32_t leaves) {
    scene::SourceMesh mesh = mesh_of({lab::make_rock(16), lab::make_foliage(leaves)});
    for (scene::Primitive& primitive : mesh.primitives) primitive.material = MaterialId(0U);
    return decide_aggregate(mesh, {.choice = AggregateChoice::kAuto});
  };
  EXPECT_EQ(both(2000).most_triangles, (Most{32})) << "3,072 triangles of rock, 4,000 of leaves";
  EXPECT_FALSE(both(1000).is_aggregate) << "crumbs of a rock";
}

TEST(AggregateParts, AreFoundByName) {
  std::vector<scene::SceneMaterial> materials(2);
  materials[0].name = "bark";
  materials[1].name = "leaf green";
  const scene::SourceMesh tree = mesh_of({lab::make_rock(16), lab::make_foliage(100)}, "oak");
  const auto decide = [&](const char* names) {
    return decide_aggregate(tree, {.choice = AggregateChoice::kNamed, .names = names, .materials = materials});
  };
  EXPECT_EQ(decide("leaf*").most_triangles, (Most{0, 512}));
  EXPECT_EQ(decide("elm,oa?").most_triangles, (Most{0, 512})) << "the mesh: all of its small pieces";
  EXPECT_NE(decide("leaf*").reason.find("'leaf green'"), std::string::npos);
  EXPECT_TRUE(decide("elm").reason.empty()) << "nobody asked for it";
  EXPECT_FALSE(decide("bark").is_aggregate);
  EXPECT_FALSE(decide("bark").reason.empty()) << "asked for, and too large";
  EXPECT_FALSE(decide("").is_aggregate);
  scene::Scene scene = lab::as_scene(tree);
  scene.materials = materials;
  EXPECT_EQ(find_unknown_names(scene, "elm,oak,,leaf*,be?ch"), (std::vector<std::string>{"elm", "be?ch"}));
}

TEST(AggregateParts, WhatAMaskFarOutLetsThroughNobodyKnows) {
  std::vector<scene::SceneMaterial> materials(3);
  materials[1].alpha_mode = materials[2].alpha_mode = scene::AlphaMode::kMask;
  materials[1].base_color_uv_set = 0;
  materials[2].base_color_uv_set = 7;  // glTF may name any; here are four
  const auto decide = [&](const scene::SourceMesh& mesh) {
    return decide_aggregate(mesh, {.choice = AggregateChoice::kAuto, .materials = materials});
  };
  scene::SourceMesh meadow = mesh_of({lab::make_grass(2000), lab::make_foliage(2000), lab::make_grass(1000)});
  EXPECT_TRUE(decide(meadow).is_aggregate);
  // It is enough that another primitive has such coordinates: one grid is stored for all.
  meadow.primitives[0].uvs[0].assign(meadow.primitives[0].positions.size(), Vec2f(0.0F, -1e8F));
  const AggregateDecision far = decide(meadow);
  EXPECT_FALSE(far.is_aggregate);
  EXPECT_NE(far.reason.find("mask"), std::string::npos) << far.reason;
  meadow.primitives[0].uvs[0].assign(meadow.primitives[0].positions.size(), Vec2f(NAN, 0.0F));
  EXPECT_FALSE(decide(meadow).is_aggregate);
  materials[1].alpha_mode = scene::AlphaMode::kOpaque;
  EXPECT_TRUE(decide(meadow).is_aggregate) << "no mask is asked there";

  materials[1].alpha_mode = scene::AlphaMode::kMask;
  scene::SourceMesh tree = mesh_of({lab::make_rock(16), lab::make_foliage(2000), lab::make_grass(1000)});
  tree.primitives[0].uvs[0].assign(tree.primitives[0].positions.size(), Vec2f(0.0F, -1e8F));
  EXPECT_EQ(decide(tree).most_triangles, (Most{0, 0, 512})) << "the grass is left";
}

/// The default: as auto where every material of the pieces is masked, and as never elsewhere.
TEST(AggregateChoice, MaskedIsOfMaskedCardsAlone) {
  std::vector<scene::SceneMaterial> materials(2);
  materials[1].alpha_mode = scene::AlphaMode::kMask;
  const auto decide = [&](const scene::SourceMesh& mesh) {
    return decide_aggregate(mesh, {.choice = AggregateChoice::kMasked, .materials = materials});
  };
  const auto all_of = [](scene::Primitive shape, std::uint32_t material) {
    shape.material = MaterialId(material);
    return lab::as_mesh(std::move(shape));
  };
  const AggregateDecision leaves = decide(all_of(lab::make_foliage(2000), 1));
  EXPECT_TRUE(leaves.is_aggregate && leaves.most_triangles.empty());
  const AggregateDecision blades = decide(all_of(lab::make_grass(2000), 0));
  EXPECT_FALSE(blades.is_aggregate);
  EXPECT_TRUE(blades.reason.empty()) << "nothing is recorded, as with never: " << blades.reason;
  materials[0].alpha_mode = scene::AlphaMode::kBlend;
  EXPECT_TRUE(decide(all_of(lab::make_grass(2000), 0)).reason.empty()) << "what is blended has no mask";
  materials[0].alpha_mode = scene::AlphaMode::kOpaque;

  EXPECT_EQ(decide(mesh_of({lab::make_rock(16), lab::make_foliage(2000)})).most_triangles, (Most{0, 512}));
  EXPECT_FALSE(decide(mesh_of({lab::make_foliage(1000), lab::make_foliage(1000)})).is_aggregate)
      << "the same cards with both materials are pieces of both";
  scene::SourceMesh meadow = mesh_of({lab::make_grass(2000), lab::make_foliage(2000)});
  for (Vec3d& p : meadow.primitives[0].positions) p.x += 100.0;
  EXPECT_EQ(decide(meadow).most_triangles, (Most{0, 512}))
      << "opaque blades stay, though all together are small pieces";
  const AggregateDecision few = decide(mesh_of({lab::make_rock(16), lab::make_foliage(100)}));
  EXPECT_FALSE(few.is_aggregate);
  EXPECT_NE(few.reason, "") << "a mesh with a mask is told why it is none";
  const scene::SourceMesh forest = all_of(lab::make_foliage(2000), 1);
  for (const bool is_topology : {true, false}) {
    const AggregateDecision kept = decide_aggregate(forest, {.choice = AggregateChoice::kMasked,
                                                             .keep_topology = is_topology,
                                                             .lock_borders = !is_topology,
                                                             .materials = materials});
    EXPECT_FALSE(kept.is_aggregate);
    EXPECT_NE(kept.reason.find("so is each piece"), std::string::npos) << kept.reason;
  }
}

TEST(AggregateParts, OfWhatIsLeftOutNothingRemains) {
  const scene::SourceMesh tree = mesh_of({lab::make_rock(16), lab::make_foliage(2000)});
  AggregateDecision decision = decide_aggregate(tree, {.choice = AggregateChoice::kAuto});
  ASSERT_EQ(decision.most_triangles, (Most{0, 512}));
  leave_out(tree, std::vector<std::uint8_t>{1, 0}, "the trunk is none", decision);
  EXPECT_EQ(decision.most_triangles, (Most{0, 512}));
  leave_out(tree, std::vector<std::uint8_t>{0, 1}, "unread", decision);
  EXPECT_FALSE(decision.is_aggregate);
  EXPECT_EQ(decision.reason, "unread");
  EXPECT_TRUE(decision.most_triangles.empty());
  leave_out(tree, std::vector<std::uint8_t>{1, 1}, "again", decision);
  EXPECT_EQ(decision.reason, "unread");
  // A piece of two materials is left out with either.
  scene::SourceMesh two = mesh_of({lab::make_rock(16), lab::make_foliage(1000), lab::make_foliage(1000)});
  decision = decide_aggregate(two, {.choice = AggregateChoice::kAuto});
  ASSERT_EQ(decision.most_triangles, (Most{0, 512, 512}));
  leave_out(two, std::vector<std::uint8_t>{0, 0, 1}, "unread", decision);
  EXPECT_FALSE(decision.is_aggregate) << "the same cards, twice";
}

TEST(CoarseMaterials, AreOpaqueDoubleSidedAndInOneColor) {
  scene::Scene scene = lab::as_scene(lab::as_mesh(lab::make_grass(10)));
  scene.document =
      R"({"materials":[{"name":"leaf","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"roughnessFactor":0.5},
    "alphaMode":"MASK"}],"other":[1,2.5]})";
  scene.materials.resize(1);
  scene::SceneMaterial& leaf = scene.materials[0];
  leaf.name = "leaf";
  leaf.source_index = 0;
  leaf.alpha_mode = scene::AlphaMode::kMask;
  leaf.base_color_texture = 0;
  leaf.textures.emplace_back();
  std::vector<std::optional<MaterialLook>> looks(1);
  looks[0] = MaterialLook{[](double u, double) { return u < 0.5; }, 1, {0.25F, 0.5F, 0.75F}};
  const std::vector<std::uint8_t> yes{1};
  EXPECT_TRUE(needs_look(leaf));
  const auto made = derive_materials(scene, yes, looks);
  ASSERT_TRUE(made.ok());
  ASSERT_EQ(made->materials.size(), 2U);
  EXPECT_EQ(made->of_source[0].coarse, 1U);
  EXPECT_EQ(made->of_source[0].uv_set, 1U);
  EXPECT_TRUE(made->of_source[0].covers(0.2, 0.0));
  const scene::SceneMaterial& coarse = made->materials[1];
  EXPECT_EQ(coarse.alpha_mode, scene::AlphaMode::kOpaque);
  EXPECT_TRUE(coarse.double_sided);
  EXPECT_EQ(coarse.source_index, 1U);
  EXPECT_EQ(coarse.base_color, Vec4f(0.25F, 0.5F, 0.75F, 1.0F));
  const auto document = nlohmann::json::parse(made->document);
  ASSERT_EQ(document["materials"].size(), 2U);
  EXPECT_EQ(document["materials"][0]["alphaMode"], "MASK") << "the source's own stays";
  EXPECT_EQ(document["other"], nlohmann::json::parse("[1,2.5]"));
  EXPECT_EQ(document["materials"][1]["doubleSided"], true);
  EXPECT_FALSE(document["materials"][1]["pbrMetallicRoughness"].contains("baseColorTexture"));
  EXPECT_EQ(document["materials"][1]["extras"]["meshlode"]["covers_as"], 0);

  leaf = {};
  leaf.source_index = 0;
  leaf.double_sided = true;
  const auto itself = derive_materials(scene, yes, std::vector<std::optional<MaterialLook>>(1));
  ASSERT_TRUE(itself.ok());
  EXPECT_EQ(itself->materials.size(), 1U) << "whole already: it stands for itself";
  EXPECT_EQ(itself->document, scene.document);
}

}  // namespace
}  // namespace meshlode::builder
