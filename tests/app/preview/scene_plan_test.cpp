// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan says before a build is what the build does.
#include "app/preview/scene_plan.h"
#include "builder/builder.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "app/preview/plan_report.h"
#include "builder/plan/count_wedges.h"
#include "builder/plan/features.h"
#include "lab/samples/samples.h"
#include "run/read/asset.h"

namespace meshlode::app {
namespace {

scene::Scene scene_of(scene::Primitive shape) {
  scene::SceneMaterial material;
  material.uv_sets_used = 1;
  shape.material = MaterialId(0U);
  scene::Scene scene = lab::as_scene(lab::as_mesh(std::move(shape)));
  scene.materials = {material};
  return scene;
}

TEST(ScenePlan, GridNormalsAndUvsAreThoseOfTheBuild) {
  for (scene::Primitive shape : {lab::make_rock(16), lab::make_foliage(40), lab::make_terrain(30, 30),
                                 lab::with_smooth_normals(lab::make_sphere(12)), lab::make_plane(3)}) {
    const scene::Scene scene = scene_of(std::move(shape));
    for (const double budget : {0.0, 1e-3}) {
      builder::PipelineOptions options;
      options.position_error = budget;
      const auto plan = plan_scene(scene, options);
      ASSERT_TRUE(plan) << plan.error().message();
      builder::PipelineReport report;
      auto bytes = builder::build_lode(scene, options, {}, report);
      ASSERT_TRUE(bytes) << bytes.error().message();
      const auto asset = run::Asset::from_vector(std::move(*bytes));
      ASSERT_TRUE(asset) << asset.error().message();
      const format::MeshRecord& built = asset->meshes()[0];
      const PlannedMesh& planned = plan->meshes[0];
      EXPECT_EQ(planned.grid.log2, built.grid.log2);
      EXPECT_EQ(planned.grid.mantissa, built.grid.mantissa);
      EXPECT_EQ(planned.layout.has_normal, built.normal_mode == format::NormalMode::kStored);
      EXPECT_EQ(planned.layout.uv_set_count, built.uv_set_count);
      EXPECT_EQ(planned.is_whole, built.level_count == 1 && built.cluster_count == 1);
      for (const PlannedAttribute& item : planned.attributes) {
        if (item.decision.attribute != "TEXCOORD_0") continue;
        // Where no texture's size is known the step goes by the extent, and simplified coordinates may reach beyond it.
        const auto says = [&](int log2) { return item.precision.starts_with("step 2^" + std::to_string(log2) + ","); };
        EXPECT_TRUE(says(built.uv_log2[0]) || says(built.uv_log2[0] - 1)) << item.precision;
      }
      // POSITION is the plan's own; the others are the build's, in its order.
      ASSERT_FALSE(planned.attributes.empty());
      EXPECT_EQ(planned.attributes[0].decision.attribute, "POSITION");
      ASSERT_LE(planned.attributes.size() - 1, report.decisions.size());
      for (std::size_t i = 1; i < planned.attributes.size(); ++i) {
        EXPECT_EQ(planned.attributes[i].decision.what, report.decisions[i - 1].what);
        EXPECT_EQ(planned.attributes[i].decision.kept, report.decisions[i - 1].kept);
      }
    }
  }
}

TEST(ScenePlan, EstimatesAreWithinAThird) {
  for (scene::Primitive shape : {lab::make_rock(24), lab::make_foliage(200), lab::make_crystal(3, 24),
                                 lab::with_smooth_normals(lab::make_sphere(40))}) {
    const scene::Scene scene = scene_of(std::move(shape));
    const auto plan = plan_scene(scene, {});
    ASSERT_TRUE(plan);
    builder::PipelineReport report;
    auto bytes = builder::build_lode(scene, {}, {}, report);
    ASSERT_TRUE(bytes);
    const auto asset = run::Asset::from_vector(std::move(*bytes));
    ASSERT_TRUE(asset);
    double pages = 0.0;
    for (const format::PageRecord& page : asset->pages()) pages += page.bytes;
    EXPECT_GT(plan->meshes[0].bytes, pages / 1.5);
    EXPECT_LT(plan->meshes[0].bytes, pages * 1.5);
  }
}

TEST(ScenePlan, WhatIsLeftOutHasASaving) {
  scene::Scene scene = scene_of(lab::with_smooth_normals(lab::make_sphere(20)));
  scene::Primitive& shape = scene.meshes[0].primitives[0];
  for (const Vec3d& p : shape.positions) shape.uvs[1].push_back({static_cast<float>(p.x), static_cast<float>(p.y)});
  const auto plan = plan_scene(scene, {});
  ASSERT_TRUE(plan);
  const auto& items = plan->meshes[0].attributes;
  const auto uvs = std::find_if(items.begin(), items.end(),
                                [](const PlannedAttribute& a) { return a.decision.attribute == "TEXCOORD_1"; });
  ASSERT_NE(uvs, items.end());
  EXPECT_FALSE(uvs->decision.kept);
  EXPECT_GT(uvs->bytes, 0.0);
  EXPECT_TRUE(uvs->precision.empty());
}

TEST(ScenePlan, TheAssetRecordsWhatRulesDecide) {
  scene::Scene scene = scene_of(lab::make_plane(3));
  scene.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  builder::PipelineReport report;
  auto bytes = builder::build_lode(scene, {}, {}, report);
  ASSERT_TRUE(bytes);
  const auto asset = run::Asset::from_vector(std::move(*bytes));
  ASSERT_TRUE(asset);
  for (const char* what : {"scene: 1 blended material", "scene: 1 of 1 meshes"}) {
    EXPECT_NE(asset->meta_json().find(std::string("{\"what\":\"") + what + "\",\"kept\":true"), std::string::npos)
        << what;
  }
}

TEST(ScenePlan, RefusesWhatTheBuildRefuses) {
  builder::PipelineOptions options;
  options.grid_step = 1e-12;
  const auto plan = plan_scene(scene_of(lab::make_sphere(4)), options);
  ASSERT_FALSE(plan);
  EXPECT_EQ(plan.error().code, ErrorCode::kUnsupported);
}

TEST(ScenePlan, AnEmptyMeshIsPassedThrough) {
  scene::Scene scene;
  scene.meshes.emplace_back().name = "nothing";
  const auto plan = plan_scene(scene, {});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->meshes[0].triangles, 0U);
  EXPECT_FALSE(plan->meshes[0].is_whole);
  EXPECT_NE(describe_plan(*plan).find("it has no triangles"), std::string::npos);
}

TEST(CountWedges, TellsVerticesApartByWhatIsKept) {
  const scene::SourceMesh facets = lab::as_mesh(lab::with_split_normals(lab::make_sphere(4)));
  builder::AttributeLayout with_normals;
  with_normals.has_normal = true;
  std::vector<std::tuple<double, double, double>> positions;
  for (const Vec3d& p : facets.primitives[0].positions) positions.emplace_back(p.x + 0.0, p.y + 0.0, p.z + 0.0);
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  EXPECT_EQ(builder::count_wedges(facets, {}).positions, positions.size());
  EXPECT_EQ(builder::count_wedges(facets, {}).wedges, positions.size());
  EXPECT_EQ(builder::count_wedges(facets, with_normals).positions, positions.size());
  EXPECT_GT(builder::count_wedges(facets, with_normals).wedges, positions.size());
}

TEST(Features, SayWhatBecomesOfEach) {
  scene::Scene scene = scene_of(lab::make_plane(1));
  scene.materials[0].alpha_mode = scene::AlphaMode::kBlend;
  scene.materials[0].double_sided = true;
  scene.materials[0].textures.push_back({.role = scene::TextureRole::kNormal});
  scene.instances.resize(2);
  scene.instances[0].mesh = scene.instances[1].mesh = MeshId(0U);
  scene.instances[1].transform[0][0] = -1.0;
  scene.document = R"({"asset":{"version":"2.0"},"cameras":[{"type":"orthographic"},{"type":"perspective"}],
    "animations":[{}],"extensionsUsed":["VENDOR_thing",7]})";
  scene.left_out.push_back({"skin 0", "meshes are built static, in their bind pose"});
  const std::vector<builder::PlanDecision> features = builder::list_features(scene, {});
  const auto has = [&](const char* what, bool kept) {
    return std::any_of(features.begin(), features.end(), [&](const builder::PlanDecision& f) {
      return f.what == what && f.kept == kept && !f.reason.empty();
    });
  };
  EXPECT_TRUE(has("1 blended material", true));
  EXPECT_TRUE(has("1 double-sided material", true));
  EXPECT_TRUE(has("1 normal map", true));
  EXPECT_TRUE(has("1 mirrored instance", true));
  EXPECT_TRUE(has("1 orthographic camera", true));
  EXPECT_TRUE(has("1 perspective camera", true));
  EXPECT_TRUE(has("1 animation", true));
  EXPECT_TRUE(has("extension VENDOR_thing", true));
  EXPECT_TRUE(has("skin 0", false));
  scene.document = "no JSON";
  EXPECT_FALSE(builder::list_features(scene, {}).empty());
}

}  // namespace
}  // namespace meshlode::app
