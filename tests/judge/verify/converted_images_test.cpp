// SPDX-License-Identifier: GPL-3.0-or-later
// V109 of converted images: what --textures makes of any picture is the source's, and another picture is not.
#include "judge/verify/converted_images.h"

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "../../draw/textures/image_samples.h"
#include "app/textures/convert_images.h"

namespace meshlode::judge {
namespace {

using scene::TextureRole;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30U;

/// Three or four channels, each by (x, y, channel).
template <class Level>
Bytes pixels_of(std::uint32_t width, std::uint32_t height, std::uint32_t channels, const Level& level) {
  Bytes out;
  for (std::uint32_t i = 0; i < width * height * channels; ++i) {
    out.push_back(static_cast<std::uint8_t>(level(i / channels % width, i / channels / width, i % channels)));
  }
  return out;
}

Bytes png_of(std::uint32_t width, std::uint32_t height, const Bytes& pixels) {
  return test::make_png(width, height, {pixels.size() == std::size_t{4} * width * height ? 6 : 2, 8}, pixels);
}

/// Every texel black or white, or of any colour.
Bytes noise(std::uint32_t width, std::uint32_t height, bool is_grey, std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  Bytes pixels = pixels_of(width, height, 3, [&](auto, auto, auto) { return random(); });
  for (std::size_t i = 0; is_grey && i < pixels.size(); ++i) pixels[i] = pixels[i - i % 3] < 128 ? 0 : 255;
  return png_of(width, height, pixels);
}

/// Facets that lean to either side by turns: their mean is far shorter than 1.
Bytes ridges() {
  return png_of(64, 64, pixels_of(64, 64, 3, [](auto x, auto, auto k) {
                  return k == 2 ? 204 : k == 1 ? 128 : x % 2 == 0 ? 26 : 230;
                }));
}

Bytes stripes_that_alpha_hides() {
  return png_of(64, 64, pixels_of(64, 64, 4, [](auto x, auto, auto k) { return (x % 2 == 0) == (k == 3) ? 255 : 0; }));
}

scene::Scene scene_of(Bytes image, TextureRole role, scene::AlphaMode mode, const char* mime_type = "image/png") {
  scene::Scene scene;
  scene.blobs.push_back({scene::SceneBlob::Kind::kImage, "image", mime_type, 0, std::move(image)});
  scene::TextureUse use;
  use.role = role;
  use.blob = 0;
  scene.materials.emplace_back().alpha_mode = mode;
  scene.materials[0].textures.push_back(use);
  return scene;
}

builder::ConvertedImage convert(const scene::Scene& scene, const std::string& words) {
  auto images = app::ImageConverter(kPlenty).convert(scene, *builder::parse_texture_choice(words));
  EXPECT_TRUE(images);
  EXPECT_FALSE(images->at(0).bytes.empty()) << words << ": " << images->at(0).note;
  return std::move(images->at(0));
}

std::string fault_of(const scene::Scene& scene, const std::string& words) {
  const builder::ConvertedImage image = convert(scene, words);
  return find_image_fault(image.bytes, image.mime_type, scene.blobs[0], read_stated_textures(words));
}

TEST(ConvertedImages, WhatTheSettingsMakeIsTheSources) {
  constexpr auto kOpaque = scene::AlphaMode::kOpaque, kMask = scene::AlphaMode::kMask;
  const Bytes colored = noise(64, 48, false), stripes = stripes_that_alpha_hides();
  const std::pair<scene::Scene, std::string> cases[] = {
      {scene_of(noise(9, 9, true), TextureRole::kBaseColor, kOpaque), "resize:8"},
      {scene_of(noise(12, 20, true), TextureRole::kBaseColor, kOpaque), "resize:16"},
      {scene_of(noise(100, 100, true), TextureRole::kBaseColor, kOpaque), "resize:99"},
      {scene_of(noise(300, 2, true), TextureRole::kBaseColor, kOpaque), "resize:7"},
      {scene_of(colored, TextureRole::kBaseColor, kOpaque), "resize:10"},
      {scene_of(colored, TextureRole::kMetallicRoughness, kOpaque), "resize:10"},
      {scene_of(colored, TextureRole::kNormal, kOpaque), "resize:12"},
      {scene_of(ridges(), TextureRole::kNormal, kOpaque), "resize:8"},
      {scene_of(stripes, TextureRole::kOther, kOpaque), "resize:16"},
      {scene_of(stripes, TextureRole::kBaseColor, kOpaque), "resize:16"},
      {scene_of(stripes, TextureRole::kBaseColor, kMask), "resize:16"},
      {scene_of(stripes, TextureRole::kEmissive, kMask), "resize:1"},
      {scene_of(noise(40, 40, false), TextureRole::kBaseColor, kOpaque), "webp:1"},
      {scene_of(noise(33, 40, false), TextureRole::kBaseColor, kOpaque), "webp:1"},
  };
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    EXPECT_EQ(fault_of(cases[i].first, cases[i].second), "") << "case " << i;
  }
}

TEST(ConvertedImages, AnotherPictureIsFound) {
  const auto source = scene_of(noise(64, 48, true), TextureRole::kBaseColor, scene::AlphaMode::kOpaque);
  std::mt19937 random(3);
  const Bytes smooth = pixels_of(64, 48, 3, [&](auto x, auto y, auto k) {
    return k == 0 ? 4 * x : k == 1 ? 5 * y : random() % 40;
  });
  const auto of = [](const Bytes& pixels) {
    return scene_of(png_of(64, 48, pixels), TextureRole::kBaseColor, scene::AlphaMode::kOpaque);
  };
  const scene::Scene picture = of(smooth);
  Bytes swapped = smooth, flipped = smooth, patched = smooth;
  for (std::size_t i = 0; i < smooth.size(); i += 3) std::swap(swapped[i], swapped[i + 2]);
  std::reverse(flipped.begin(), flipped.end());
  for (std::size_t y = 0; y < 6; ++y)
    std::fill_n(patched.begin() + static_cast<std::ptrdiff_t>(3 * 64 * y), 24, std::uint8_t{200});
  for (const char* const words : {"resize:32", "webp", "resize:20,webp:50"}) {
    const builder::ConvertedImage own = convert(picture, words);
    const StatedTextures stated = read_stated_textures(words);
    EXPECT_EQ(find_image_fault(own.bytes, own.mime_type, picture.blobs[0], stated), "") << words;
    for (const scene::Scene& other : {source, of(swapped), of(flipped), of(patched)}) {
      EXPECT_NE(find_image_fault(own.bytes, own.mime_type, other.blobs[0], stated), "") << words;
    }
  }
}

TEST(ConvertedImages, ASourceMayCallItsBytesWhatTheyAreNot) {
  const Bytes jpeg =
      test::make_jpeg(64, 64, 3, false, pixels_of(64, 64, 3, [](auto x, auto, auto k) { return 3 * x + k; }));
  for (const char* const type : {"image/png", "image/jpeg", "", "text/plain"}) {
    for (const Bytes& bytes : {jpeg, noise(64, 64, true)}) {
      const auto scene = scene_of(bytes, TextureRole::kBaseColor, scene::AlphaMode::kOpaque, type);
      EXPECT_EQ(fault_of(scene, "resize:32"), "") << type;
      const StatedTextures stated = read_stated_textures("resize:32");
      const builder::ConvertedImage image = convert(scene, "resize:32");
      EXPECT_NE(find_image_fault(image.bytes, "image/webp", scene.blobs[0], stated), "");
      EXPECT_NE(find_image_fault(scene.blobs[0].bytes, "image/webp", scene.blobs[0], stated), "");
    }
  }
}

}  // namespace
}  // namespace meshlode::judge
