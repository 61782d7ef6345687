// SPDX-License-Identifier: GPL-3.0-or-later
// Budgets in texels: the judge measures images by itself, and a step that is too coarse for one is found.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/image_size.h"
#include "builder/plan/texel_sizes.h"
#include "judge/validate/judged_sample.h"
#include "judge/verify/texel_budget.h"
#include "run/read/asset.h"
#include "support/png_header.h"
#include "support/sample_asset.h"

namespace meshlode::judge {
namespace {

std::vector<std::optional<double>> same_for_all(const run::Asset& asset, double texels) {
  return std::vector<std::optional<double>>(asset.meshes().size(), texels);
}

/// The sample, whose materials all sample one texture of this width by each of their coordinates.
scene::Scene scene_with(std::uint32_t width) {
  scene::Scene scene = test::sample_scene();
  scene.blobs[0].bytes = test::png_of(width, 4);
  for (scene::SceneMaterial& material : scene.materials) {
    const auto add = [&](std::uint32_t uv_set, std::array<double, 2> scale) {
      scene::TextureUse& use = material.textures.emplace_back();
      use.blob = 0;
      use.uv_set = uv_set;
      use.scale = scale;
    };
    add(0, {1.0, 1.0});
    add(1, {1.0, 1.0});
    add(2, {-2.0, 1.0});
    add(scene::kMaxUvSets, {1.0, 1.0});
    material.textures.emplace_back().uv_set = 3;  // of no image
  }
  return scene;
}

TEST(TexelBudget, TexelsAreCountedAsTheBuildCountsThem) {
  const scene::Scene scene = scene_with(300);
  const auto of_materials = most_texels_of_materials(scene);
  for (const scene::SourceMesh& mesh : scene.meshes) {
    const auto most = most_texels(of_materials, mesh);
    EXPECT_EQ(most, builder::texels_per_unit(scene, mesh));
    const bool has_material =
        std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                    [&](const scene::Primitive& p) { return p.material.value < scene.materials.size(); });
    if (!has_material) continue;
    EXPECT_EQ(most[0], 300.0);
    EXPECT_EQ(most[1], 300.0);
    EXPECT_EQ(most[2], 600.0) << "scaled";
    EXPECT_EQ(most[3], 0.0);
  }
}

TEST(TexelBudget, ImagesOfUnknownKindsHaveNoSize) {
  EXPECT_FALSE(stated_image_size({}));
  const std::vector<std::uint8_t> dds{'D', 'D', 'S', ' ', 124, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0};
  EXPECT_FALSE(stated_image_size(dds));
  const auto png = test::png_of(7, 9);
  for (std::size_t size = 0; size < png.size(); ++size) (void)stated_image_size(std::span(png).first(size));
  ASSERT_TRUE(stated_image_size(png));
  EXPECT_EQ(stated_image_size(png)->second, 9U);
}

TEST(TexelBudget, KtxAndWebpStateTheirSizeToBothReaders) {
  const auto bytes_of = [](std::initializer_list<int> values) {
    std::vector<std::uint8_t> bytes;
    for (const int value : values) bytes.push_back(static_cast<std::uint8_t>(value));
    return bytes;
  };
  const auto ktx = bytes_of(
      {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 13, 10, 26, 10, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1, 0, 0, 3, 0, 0, 0});
  const auto webp = [&](char kind, std::initializer_list<int> data) {
    auto bytes = bytes_of({'R', 'I', 'F', 'F', 22, 0, 0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8', kind, 10, 0, 0, 0});
    for (const int value : data) bytes.push_back(static_cast<std::uint8_t>(value));
    return bytes;
  };
  std::mt19937 random(7);
  for (int round = 0; round < 3000; ++round) {
    for (auto bytes :
         {ktx, webp(' ', {0x30, 1, 0, 0x9D, 1, 0x2A, 0x26, 0x42, 0x70, 0x81}),
          webp('L', {0x2F, 0x81, 0x81, 0x62, 0x10, 0, 0, 0, 0, 0}), webp('X', {0x10, 0, 0, 0, 0, 0, 1, 1, 0, 0})}) {
      ASSERT_TRUE(stated_image_size(bytes));
      const std::size_t changes = round == 0 ? 0 : 1 + random() % 3;
      for (std::size_t i = 0; i < changes; ++i)
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
      if (round % 5 == 4) bytes.resize(random() % bytes.size());
      const auto judged = stated_image_size(bytes);
      const auto built = read_image_size(bytes);
      ASSERT_EQ(judged.has_value(), built.has_value()) << "round " << round;
      if (!built) continue;
      ASSERT_EQ(judged->first, built->width) << "round " << round;
      ASSERT_EQ(judged->second, built->height) << "round " << round;
    }
  }
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
    check_texel_budget(*asset, scene_with(is_too_wide ? 2 * width : width), same_for_all(*asset, 0.25), *clusters, log);
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
    check_texel_budget(*asset, scene_with(1U << 20U), same_for_all(*asset, 1e-6), *clusters, log);
    EXPECT_EQ(log.count_of(Rule::kV113) == 0, largest != (1 << 23) - 1) << largest;
  }
}

}  // namespace
}  // namespace meshlode::judge
