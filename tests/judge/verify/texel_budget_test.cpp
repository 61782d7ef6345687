// SPDX-License-Identifier: GPL-3.0-or-later
// Budgets in texels: the judge finds the textures by itself, and a step that is too coarse for one is found.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "build/plan/texel_sizes.h"
#include "judge/validate/judged_sample.h"
#include "judge/verify/texel_budget.h"
#include "run/read/asset.h"
#include "support/sample_asset.h"

namespace meshlode::judge {
namespace {

/// A PNG's signature and header.
std::vector<std::uint8_t> png_of(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> bytes{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
  for (const std::uint32_t size : {width, height}) {
    for (std::uint32_t shift = 32; shift > 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(size >> (shift - 8)));
  }
  for (const int b : {8, 6, 0, 0, 0, 0, 0, 0, 0}) bytes.push_back(static_cast<std::uint8_t>(b));
  return bytes;
}

/// The sample, whose materials all sample one texture of this width by each of their coordinates.
scene::Scene scene_with(std::uint32_t width) {
  scene::Scene scene = test::sample_scene();
  scene.blobs[0].bytes = png_of(width, 4);
  std::string materials;
  std::uint32_t count = 0;
  for (scene::SceneMaterial& material : scene.materials) {
    material.source_index = count++;
    materials += materials.empty() ? "" : ",";
    materials +=
        R"({"normalTexture":{"index":0},"emissiveTexture":{"index":0,"texCoord":1},)"
        R"("extensions":{"X":{"t":{"index":0,"extensions":{"KHR_texture_transform":{"texCoord":2,"scale":[-2,1]}}}}}})";
  }
  scene.document = R"({"images":[{"blob":0}],"textures":[{"source":0}],"materials":[)" + materials + "]}";
  return scene;
}

TEST(TexelBudget, TexturesAreFoundAsTheBuildFindsThem) {
  const scene::Scene scene = scene_with(300);
  const auto of_materials = most_texels_of_materials(scene);
  for (const scene::SourceMesh& mesh : scene.meshes) {
    const auto most = most_texels(of_materials, mesh);
    EXPECT_EQ(most, build::texels_per_unit(scene, mesh));
    const bool has_material =
        std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                    [&](const scene::Primitive& p) { return p.material.value < scene.materials.size(); });
    if (!has_material) continue;
    EXPECT_EQ(most[0], 300.0);
    EXPECT_EQ(most[1], 300.0);
    EXPECT_EQ(most[2], 600.0) << "scaled, by an extension nobody knows";
    EXPECT_EQ(most[3], 0.0);
  }
}

TEST(TexelBudget, ImagesOfUnknownKindsHaveNoSize) {
  EXPECT_FALSE(stated_image_size({}));
  const std::vector<std::uint8_t> ktx{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
  EXPECT_FALSE(stated_image_size(ktx));
  const auto png = png_of(7, 9);
  for (std::size_t size = 0; size < png.size(); ++size) (void)stated_image_size(std::span(png).first(size));
  ASSERT_TRUE(stated_image_size(png));
  EXPECT_EQ(stated_image_size(png)->second, 9U);
}

/// The largest image that a budget of a quarter of a texel allows, and one of twice the width.
TEST(TexelBudget, AStepThatIsTooCoarseForATextureIsFound) {
  const auto asset = run::Asset::from_vector(test::judged_sample_bytes());
  ASSERT_TRUE(asset.ok());
  const auto clusters = run::decode_all(*asset);
  ASSERT_TRUE(clusters.ok());
  std::int32_t coarsest = -1000;
  for (const format::MeshRecord& mesh : asset->meshes()) {
    for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) coarsest = std::max(coarsest, mesh.uv_log2[set]);
  }
  ASSERT_LT(coarsest, -4);
  const auto width = static_cast<std::uint32_t>(std::ldexp(0.25, 1 - coarsest));
  for (const bool is_too_wide : {false, true}) {
    RuleLog log;
    check_texel_budget(*asset, scene_with(is_too_wide ? 2 * width : width), 0.25, *clusters, log);
    EXPECT_EQ(log.count_of(Rule::kV113) > 0, is_too_wide) << width;
  }
}

// A coordinate of more than half of what 24 bits hold leaves no finer step; one of less does.
TEST(TexelBudget, AStepAsFineAsTheCoordinatesLeaveIsWithinAnyBudget) {
  const auto asset = run::Asset::from_vector(test::judged_sample_bytes());
  ASSERT_TRUE(asset.ok());
  auto clusters = run::decode_all(*asset);
  ASSERT_TRUE(clusters.ok());
  for (const std::int32_t largest : {(1 << 23) - 1, 1 << 23, -(1 << 23)}) {
    bool is_any_set = false;
    for (std::size_t m = 0; m < asset->meshes().size(); ++m) {
      const format::MeshRecord& mesh = asset->meshes()[m];
      const std::size_t first_uv = mesh.normal_mode == format::NormalMode::kStored ? 6 : 3;
      for (std::uint32_t set = 0; set < mesh.uv_set_count; ++set) {
        is_any_set = true;
        (*clusters)[mesh.first_cluster].channels[first_uv + 2 * set + 1] = largest;
      }
    }
    ASSERT_TRUE(is_any_set);
    RuleLog log;
    check_texel_budget(*asset, scene_with(1U << 20U), 1e-6, *clusters, log);
    EXPECT_EQ(log.count_of(Rule::kV113) == 0, largest != (1 << 23) - 1) << largest;
  }
}

}  // namespace
}  // namespace meshlode::judge
