// SPDX-License-Identifier: GPL-3.0-or-later
// Masks of materials: thresholds against a search of all products, images decoded once and only where they are asked.
#include <gtest/gtest.h>

#include "draw/textures/alpha_mask.h"
#include "support/mask_scene.h"

namespace meshlode::draw {
namespace {

run::Asset open(const scene::Scene& scene) {
  auto asset = run::Asset::from_vector(test::built(scene));
  EXPECT_TRUE(asset) << (asset ? "" : asset.error().message());
  return std::move(asset).value();
}

TEST(AlphaMask, TheThresholdIsTheLeastProductThatReachesTheCutoff) {
  for (const float factor : {0.0F, 0.1F, 0.5F, 0.7F, 1.0F}) {
    for (const float cutoff : {-1.0F, 0.0F, 1e-6F, 0.2F, 0.25F, 0.5F, 0.7F, 1.0F, 1.0001F, 3.0F}) {
      std::uint32_t least = kMaskThresholdNever;
      for (std::uint32_t p = 0; p <= 65025 && least == kMaskThresholdNever; ++p) {
        if (static_cast<float>(p) / 65025.0F * factor >= cutoff) least = p;
      }
      EXPECT_EQ(mask_threshold(factor, cutoff), least) << factor << " " << cutoff;
    }
  }
  EXPECT_EQ(mask_threshold(-1.0F, 0.5F), kMaskThresholdNever);
  // An 8-bit alpha that is the cutoff itself passes: 51 / 255 = 0.2 in floats.
  EXPECT_LE(mask_threshold(1.0F, 0.2F), 255u * 51u);
  EXPECT_GT(mask_threshold(1.0F, 0.2F), 255u * 50u);
  EXPECT_EQ(mask_threshold(1.0F, 1.0F), 65025u);
}

TEST(AlphaMask, MaterialsShareAnImageAndOpaqueOnesHaveNoMask) {
  const run::Asset asset = open(test::mask_scene({}));
  const AlphaMasks masks = load_alpha_masks(asset);
  EXPECT_TRUE(masks.warnings.empty());
  ASSERT_EQ(masks.masks.size(), 9u);
  ASSERT_EQ(masks.images.size(), 1u);
  ASSERT_EQ(masks.of_material.size(), asset.materials().size());
  const AlphaImage& image = masks.images[0];
  ASSERT_EQ(image.width, test::kMaskTextureWidth);
  ASSERT_EQ(image.height, test::kMaskTextureHeight);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      EXPECT_EQ(image.texels[y * image.width + x], test::mask_texture_alpha(x, y));
    }
  }
  for (std::size_t i = 0; i < asset.materials().size(); ++i) {
    const bool is_masked = asset.materials()[i].alpha_mode == format::AlphaMode::kMask;
    ASSERT_EQ(masks.of_material[i] != format::kNone, is_masked);
    if (!is_masked) continue;
    const AlphaMask& mask = masks.masks[masks.of_material[i]];
    const std::uint32_t k = asset.materials()[i].source_index - 1;
    constexpr Wrap kWraps[] = {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp};
    EXPECT_EQ(mask.wrap[0], kWraps[k % 3]);
    EXPECT_EQ(mask.wrap[1], kWraps[k / 3]);
    EXPECT_EQ(mask.row_u[0], double{test::kMaskTextureWidth});
    EXPECT_EQ(mask.row_v[1], double{test::kMaskTextureHeight});
  }
}

TEST(AlphaMask, WhatAlwaysPassesIsNoMask) {
  test::MaskSceneOptions options;
  options.cutoff = 0.0F;
  EXPECT_TRUE(load_alpha_masks(open(test::mask_scene(options))).is_empty());
  scene::Scene scene = test::mask_scene({});
  for (scene::SceneMaterial& m : scene.materials) m.alpha_mode = scene::AlphaMode::kBlend;
  const AlphaMasks masks = load_alpha_masks(open(scene));
  EXPECT_TRUE(masks.is_empty());
  EXPECT_TRUE(masks.images.empty()) << "no image is decoded that nobody asks for";
}

TEST(AlphaMask, AnImageThatCannotBeHadIsOpaqueAndSaysSo) {
  test::MaskSceneOptions options;
  options.image = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A, 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0};
  const AlphaMasks broken = load_alpha_masks(open(test::mask_scene(options)));
  EXPECT_EQ(broken.warnings.size(), 1u) << "once an image, not once a material";
  ASSERT_EQ(broken.masks.size(), 9u);
  for (const AlphaMask& mask : broken.masks) EXPECT_EQ(mask.image, format::kNone);

  options.image = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
  const AlphaMasks carried = load_alpha_masks(open(test::mask_scene(options)));
  ASSERT_EQ(carried.warnings.size(), 1u);
  EXPECT_NE(carried.warnings[0].find("KTX2"), std::string::npos) << carried.warnings[0];
  for (const AlphaMask& mask : carried.masks) EXPECT_EQ(mask.image, format::kNone);

  scene::Scene scene = test::mask_scene({});
  const std::size_t at = scene.document.find(R"("blob":0)");
  ASSERT_NE(at, std::string::npos);
  scene.document.replace(at, 8, R"("blob":9)");
  const AlphaMasks missing = load_alpha_masks(open(scene));
  EXPECT_FALSE(missing.warnings.empty());
  for (const AlphaMask& mask : missing.masks) EXPECT_EQ(mask.image, format::kNone);
}

}  // namespace
}  // namespace meshlode::draw
