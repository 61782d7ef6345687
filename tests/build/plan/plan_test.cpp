// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/plan/plan.h"

#include <gtest/gtest.h>

#include "scene/samples/samples.h"

namespace meshlode::build {
namespace {

std::vector<scene::SceneMaterial> one_material(std::uint32_t uv_sets_used) {
  scene::SceneMaterial material;
  material.uv_sets_used = uv_sets_used;
  return {material};
}

scene::SourceMesh textured_sphere() {
  scene::SourceMesh mesh = scene::as_mesh(scene::with_smooth_normals(scene::make_sphere(4)));
  mesh.primitives[0].material = MaterialId(0U);
  mesh.primitives[0].uvs[0].assign(mesh.primitives[0].positions.size(), Vec2f(0.5F));
  mesh.primitives[0].uvs[1].assign(mesh.primitives[0].positions.size(), Vec2f(0.25F));
  return mesh;
}

TEST(Plan, KeepsOnlyTheUvSetsThatAMaterialSamples) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(2), AttributeChoice::kAuto, "m");
  ASSERT_EQ(plan.layout.uv_set_count, 1U);
  EXPECT_EQ(plan.layout.uv_set_source[0], 1);
}

TEST(Plan, KeepsNothingButPositionsWhenAskedTo) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(3), AttributeChoice::kNone, "m");
  EXPECT_EQ(plan.layout.stride(), 0U);
  EXPECT_FALSE(plan.layout.flat_normal);
  EXPECT_EQ(plan.decisions.size(), 3U) << "normals and both uv sets are reported as left out";
}

TEST(Plan, KeepsEverythingWhenAskedTo) {
  const MeshPlan plan = plan_mesh(textured_sphere(), one_material(0), AttributeChoice::kAll, "m");
  EXPECT_EQ(plan.layout.uv_set_count, 2U);
  EXPECT_TRUE(plan.layout.has_normal);
}

/// What can be seen and is not kept is told from what nobody misses.
TEST(Plan, TangentsAreALossOnlyWhereAMaterialShowsThem) {
  scene::SourceMesh mesh = textured_sphere();
  std::vector<scene::SceneMaterial> materials = one_material(1);
  const auto loss_of = [&](AttributeChoice choice) {
    const MeshPlan plan = plan_mesh(mesh, materials, choice, "m");
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
  const scene::SourceMesh facets = scene::as_mesh(scene::with_split_normals(scene::make_sphere(4)));
  const MeshPlan plan = plan_mesh(facets, {}, AttributeChoice::kAuto, "m");
  EXPECT_TRUE(plan.layout.flat_normal);
  EXPECT_FALSE(plan.layout.has_normal);
}

TEST(Plan, StoresNormalsIfASingleOneIsNotItsTrianglesOwn) {
  scene::SourceMesh facets = scene::as_mesh(scene::with_split_normals(scene::make_sphere(4)));
  Vec3f& normal = facets.primitives[0].normals[7];
  normal = glm::normalize(normal + Vec3f(0.3F, 0.1F, 0.0F));
  EXPECT_TRUE(plan_mesh(facets, {}, AttributeChoice::kAuto, "m").layout.has_normal);
}

TEST(Plan, MissingNormalsAreFlat) {
  const MeshPlan plan = plan_mesh(scene::as_mesh(scene::make_sphere(2)), {}, AttributeChoice::kAuto, "m");
  EXPECT_TRUE(plan.layout.flat_normal);
}

TEST(Plan, LeavesOutWhiteColorsAndKeepsOthers) {
  scene::SourceMesh mesh = scene::as_mesh(scene::make_sphere(2));
  mesh.primitives[0].colors.assign(mesh.primitives[0].positions.size(), Vec4f(1.0F));
  EXPECT_FALSE(plan_mesh(mesh, {}, AttributeChoice::kAuto, "m").layout.has_color);
  mesh.primitives[0].colors[3].y = 0.5F;
  EXPECT_TRUE(plan_mesh(mesh, {}, AttributeChoice::kAuto, "m").layout.has_color);
}

}  // namespace
}  // namespace meshlode::build
