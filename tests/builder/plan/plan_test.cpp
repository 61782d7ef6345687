// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/plan/plan.h"

#include <gtest/gtest.h>

#include "builder/plan/attributes.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

std::vector<scene::SceneMaterial> one_material(std::uint32_t uv_sets_used) {
  scene::SceneMaterial material;
  material.uv_sets_used = uv_sets_used;
  return {material};
}

scene::SourceMesh textured_sphere() {
  scene::SourceMesh mesh = lab::as_mesh(lab::with_smooth_normals(lab::make_sphere(4)));
  mesh.primitives[0].material = MaterialId(0U);
  mesh.primitives[0].uvs[0].assign(mesh.primitives[0].positions.size(), Vec2f(0.5F));
  mesh.primitives[0].uvs[1].assign(mesh.primitives[0].positions.size(), Vec2f(0.25F));
  return mesh;
}

TEST(Plan, KeepsOnlyTheUvSetsThatAMaterialSamples) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(2), {AttributeChoice::kAuto}, "m");
  ASSERT_EQ(plan.layout.uv_set_count, 1U);
  EXPECT_EQ(plan.layout.uv_set_source[0], 1);
}

TEST(Plan, KeepsNothingButPositionsWhenAskedTo) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(3), {AttributeChoice::kNone}, "m");
  EXPECT_EQ(plan.layout.stride(), 0U);
  EXPECT_FALSE(plan.layout.flat_normal);
  EXPECT_EQ(plan.decisions.size(), 3U) << "normals and both uv sets are reported as left out";
}

TEST(Plan, KeepsEverythingWhenAskedTo) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(0), {AttributeChoice::kAll}, "m");
  EXPECT_EQ(plan.layout.uv_set_count, 2U);
  EXPECT_TRUE(plan.layout.has_normal);
}

/// What can be seen and is not kept is told from what nobody misses.
TEST(Plan, TangentsAreALossOnlyWhereAMaterialShowsThem) {
  scene::SourceMesh mesh = textured_sphere();
  std::vector<scene::SceneMaterial> materials = one_material(1);
  const auto loss_of = [&](AttributeChoice choice) {
    const MeshPlan plan = plan_mesh(mesh, materials, {choice}, "m");
    int losses = 0;
    int tangents = 0;
    for (const PlanDecision& decision : plan.decisions) {
      losses += decision.is_loss ? 1 : 0;
      tangents += decision.what == "m: TANGENT" && !decision.kept ? 1 : 0;
    }
    return std::pair(losses, tangents);
  };
  EXPECT_EQ(loss_of(AttributeChoice::kAuto), std::pair(0, 0)) << "the source has none";
  mesh.primitives[0].has_tangents = true;
  EXPECT_EQ(loss_of(AttributeChoice::kAuto), std::pair(0, 1)) << "no normal map";
  materials[0].needs_tangents = true;
  EXPECT_EQ(loss_of(AttributeChoice::kAuto), std::pair(1, 1));
  EXPECT_EQ(loss_of(AttributeChoice::kAll), std::pair(1, 1));
  EXPECT_EQ(loss_of(AttributeChoice::kNone), std::pair(0, 1)) << "asked for";
}

TEST(Plan, DerivesNormalsThatAreTheTrianglesOwn) {
  const scene::SourceMesh facets = lab::as_mesh(lab::with_split_normals(lab::make_sphere(4)));
  const MeshPlan plan = plan_mesh(facets, {}, {AttributeChoice::kAuto}, "m");
  EXPECT_TRUE(plan.layout.flat_normal);
  EXPECT_FALSE(plan.layout.has_normal);
}

TEST(Plan, StoresNormalsIfASingleOneIsNotItsTrianglesOwn) {
  scene::SourceMesh facets = lab::as_mesh(lab::with_split_normals(lab::make_sphere(4)));
  Vec3f& normal = facets.primitives[0].normals[7];
  normal = glm::normalize(normal + Vec3f(0.3F, 0.1F, 0.0F));
  EXPECT_TRUE(plan_mesh(facets, {}, {AttributeChoice::kAuto}, "m").layout.has_normal);
}

/// A quarter of a degree is not seen, and is more than a promise of normals allows; what floats lose is not.
TEST(Plan, WherePromisedNormalsAreFlatOnlyAsFarAsFloatsTell) {
  scene::SourceMesh facets = lab::as_mesh(lab::with_split_normals(lab::make_sphere(4)));
  AttributeRequest promised;
  promised.promises_normals = true;
  EXPECT_TRUE(plan_mesh(facets, {}, promised, "m").layout.flat_normal);
  Vec3f& normal = facets.primitives[0].normals[7];
  const Vec3f exact = normal;
  normal = glm::normalize(exact + Vec3f(4e-7F, 4e-7F, -4e-7F));  // as six decimals may leave it
  EXPECT_TRUE(plan_mesh(facets, {}, promised, "m").layout.has_normal);
  normal = exact;
  normal = glm::normalize(normal + Vec3f(0.003F, 0.003F, -0.003F));
  EXPECT_TRUE(plan_mesh(facets, {}, {}, "m").layout.flat_normal);
  EXPECT_TRUE(plan_mesh(facets, {}, promised, "m").layout.has_normal);
  EXPECT_FALSE(plan_mesh(facets, {}, promised, "m").layout.flat_normal);
}

TEST(Plan, MissingNormalsAreFlat) {
  const MeshPlan plan = plan_mesh(lab::as_mesh(lab::make_sphere(2)), {}, {AttributeChoice::kAuto}, "m");
  EXPECT_TRUE(plan.layout.flat_normal);
}

TEST(Plan, LeavesOutWhiteColorsAndKeepsOthers) {
  scene::SourceMesh mesh = lab::as_mesh(lab::make_sphere(2));
  mesh.primitives[0].colors.assign(mesh.primitives[0].positions.size(), Vec4f(1.0F));
  EXPECT_FALSE(plan_mesh(mesh, {}, {AttributeChoice::kAuto}, "m").layout.has_color);
  mesh.primitives[0].colors[3].y = 0.5F;
  EXPECT_TRUE(plan_mesh(mesh, {}, {AttributeChoice::kAuto}, "m").layout.has_color);
}

TEST(Plan, NamesGoBeforeTheRule) {
  const auto plan_of = [](const AttributeRequest& request) {
    return plan_mesh(textured_sphere(), one_material(1), request, "m");
  };
  const MeshPlan kept = plan_of({AttributeChoice::kAuto, attribute_texcoord(1), 0});
  EXPECT_EQ(kept.layout.uv_set_count, 2U);
  EXPECT_EQ(forced_attributes(kept.decisions, true), attribute_texcoord(1));
  const MeshPlan dropped = plan_of({AttributeChoice::kAuto, 0, kAttributeNormal | attribute_texcoord(0)});
  EXPECT_EQ(dropped.layout.stride(), 0U);
  EXPECT_FALSE(dropped.layout.flat_normal) << "they are not the triangles' own";
  EXPECT_EQ(forced_attributes(dropped.decisions, false), kAttributeNormal | attribute_texcoord(0));
  const MeshPlan only = plan_of({AttributeChoice::kNone, kAttributeNormal, 0});
  EXPECT_TRUE(only.layout.has_normal);
  EXPECT_EQ(only.layout.uv_set_count, 0U);
  const MeshPlan all_but = plan_of({AttributeChoice::kAll, 0, attribute_texcoord(1)});
  EXPECT_EQ(all_but.layout.uv_set_count, 1U);
}

TEST(Plan, ANameThatChangesNothingForcesNothing) {
  const MeshPlan plan = plan_mesh(
      textured_sphere(), one_material(1),
      {AttributeChoice::kAuto, kAttributeNormal | attribute_texcoord(3), kAttributeColor | attribute_texcoord(1)}, "m");
  EXPECT_EQ(forced_attributes(plan.decisions, true), 0U);
  EXPECT_EQ(forced_attributes(plan.decisions, false), 0U);
  EXPECT_EQ(plan.layout.uv_set_count, 1U);
  EXPECT_FALSE(plan.layout.has_color);
}

TEST(Plan, FlatNormalsAreStoredOnlyByName) {
  const scene::SourceMesh facets = lab::as_mesh(lab::with_split_normals(lab::make_sphere(4)));
  EXPECT_TRUE(plan_mesh(facets, {}, {AttributeChoice::kAll}, "m").layout.flat_normal);
  const MeshPlan stored = plan_mesh(facets, {}, {AttributeChoice::kAuto, kAttributeNormal, 0}, "m");
  EXPECT_TRUE(stored.layout.has_normal);
  EXPECT_FALSE(stored.layout.flat_normal);
  const MeshPlan dropped = plan_mesh(facets, {}, {AttributeChoice::kAuto, 0, kAttributeNormal}, "m");
  EXPECT_TRUE(dropped.layout.flat_normal) << "nothing is stored for them anyway";
}

TEST(Attributes, AreReadByName) {
  EXPECT_EQ(*parse_attributes(""), 0U);
  EXPECT_EQ(*parse_attributes("all"), kAllAttributes);
  EXPECT_EQ(*parse_attributes("NORMAL,TEXCOORD_3"), kAttributeNormal | attribute_texcoord(3));
  EXPECT_EQ(names_of_attributes(kAttributeColor | kAttributeNormal), (std::vector<std::string>{"NORMAL", "COLOR_0"}));
  EXPECT_EQ(names_of_attributes(kAllAttributes).size(), kAttributeNames.size());
  for (const auto& [word, nearest] : {std::pair("NORMALS", "NORMAL"),
                                      {"color_0", "COLOR_0"},
                                      {"TEXCORD_1", "TEXCOORD_1"},
                                      {"all,NORMAL", "all"},
                                      {"ALL", "all"}}) {
    const auto bits = parse_attributes(word);
    ASSERT_FALSE(bits) << word;
    EXPECT_TRUE(bits.error().detail.ends_with(std::string("the nearest is ") + nearest)) << bits.error().detail;
  }
  for (const char* word : {",", "NORMAL,", ",NORMAL", "TANGENT", "POSITION", " NORMAL"}) {
    EXPECT_FALSE(parse_attributes(word)) << word;
  }
}

}  // namespace
}  // namespace meshlode::builder
