// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/textures/convert_images.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "../../draw/textures/image_samples.h"
#include "app/textures/encode.h"
#include "app/textures/shrink.h"
#include "draw/textures/image.h"

namespace meshlode::app {
namespace {

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30U;

/// Smooth in red, noise in green, so that lossy and lossless differ.
std::vector<std::uint8_t> pixels_of(std::uint32_t side, int channels) {
  std::mt19937 random(3);
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t i = 0; i < side * side; ++i) {
    const std::uint8_t texel[] = {static_cast<std::uint8_t>(255 * (i % side) / side),
                                  static_cast<std::uint8_t>(random() % 64), static_cast<std::uint8_t>(i / side % 256),
                                  255};
    pixels.insert(pixels.end(), texel, texel + channels);
  }
  return pixels;
}

std::vector<std::uint8_t> png(std::uint32_t side) {
  return test::make_png(side, side, {2, 8}, pixels_of(side, 3));
}

scene::Scene scene_of(std::vector<std::vector<std::uint8_t>> images, const std::vector<scene::TextureRole>& roles) {
  scene::Scene scene;
  scene::SceneMaterial& material = scene.materials.emplace_back();
  for (std::uint32_t i = 0; i < images.size(); ++i) {
    scene.blobs.push_back({scene::SceneBlob::Kind::kImage, "image", "image/png", i, std::move(images[i])});
    if (i >= roles.size()) continue;
    scene::TextureUse use;
    use.role = roles[i];
    use.blob = i;
    material.textures.push_back(use);
  }
  return scene;
}

builder::TextureChoice choice_of(const char* words) {
  return *builder::parse_texture_choice(words);
}

double psnr(const draw::DecodedImage& a, const draw::DecodedImage& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.rgba().size(); ++i) {
    const int d = int{a.rgba()[i]} - int{b.rgba()[i]};
    squares += d * d;
  }
  return squares == 0.0 ? INFINITY : 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(a.rgba().size()) / squares);
}

TEST(ConvertImages, ColoursAreLossyAndAllElseIsNot) {
  using scene::TextureRole;
  const auto scene = scene_of({png(64), png(64), png(64), png(64)},
                              {TextureRole::kBaseColor, TextureRole::kNormal, TextureRole::kMetallicRoughness});
  const auto images = ImageConverter(kPlenty).convert(scene, choice_of("webp"));
  ASSERT_TRUE(images);
  const auto source = draw::decode_image(scene.blobs[0].bytes);
  for (std::size_t i = 0; i < images->size(); ++i) {
    ASSERT_FALSE((*images)[i].bytes.empty()) << (*images)[i].note;
    EXPECT_EQ((*images)[i].mime_type, "image/webp");
    EXPECT_LT((*images)[i].bytes.size(), scene.blobs[i].bytes.size());
    const auto decoded = draw::decode_image((*images)[i].bytes);
    ASSERT_TRUE(decoded);
    EXPECT_EQ(std::isinf(psnr(*decoded, *source)), i > 0) << "the fourth is sampled by nothing";
    EXPECT_GT(psnr(*decoded, *source), 25.0);
  }
}

TEST(ConvertImages, FlatColoursAndSwatchesLoseNothing) {
  std::mt19937 random(3);
  std::vector<std::uint32_t> colors(16), swatches(256);
  for (std::uint32_t& c : colors) c = static_cast<std::uint32_t>(random());
  for (std::uint32_t& c : swatches) c = colors[random() % colors.size()];
  const auto flat = [&](std::uint32_t side, std::uint32_t swatch) {
    std::vector<std::uint8_t> pixels;
    for (std::uint32_t i = 0; i < side * side; ++i) {
      const std::uint32_t c = swatches[i / side / swatch * 16 + i % side / swatch];
      for (std::uint32_t k = 0; k < 3; ++k) pixels.push_back(static_cast<std::uint8_t>(c >> 8U * k));
    }
    return test::make_png(side, side, {2, 8}, pixels);
  };
  const auto scene =
      scene_of({flat(256, 16), flat(16, 1), flat(8, 1)},
               {scene::TextureRole::kBaseColor, scene::TextureRole::kBaseColor, scene::TextureRole::kEmissive});
  const auto images = ImageConverter(kPlenty).convert(scene, choice_of("webp:50"));
  ASSERT_TRUE(images);
  for (std::size_t i = 0; i < images->size(); ++i) {
    ASSERT_FALSE((*images)[i].bytes.empty()) << (*images)[i].note;
    EXPECT_EQ(draw::decode_image((*images)[i].bytes)->texels, draw::decode_image(scene.blobs[i].bytes)->texels) << i;
  }
}

/// Red where it is transparent, blue where it is opaque, by columns.
std::vector<std::uint8_t> hidden_red() {
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t i = 0; i < 64 * 64; ++i) {
    const bool is_red = i % 2 == 0;
    pixels.insert(pixels.end(),
                  {std::uint8_t(is_red ? 255 : 0), 0, std::uint8_t(is_red ? 0 : 255), std::uint8_t(is_red ? 0 : 255)});
  }
  return test::make_png(64, 64, {6, 8}, pixels);
}

TEST(ConvertImages, AlphaHasAWeightOnlyWhereAMaterialReadsIt) {
  using scene::AlphaMode, scene::TextureRole;
  const auto texel_of = [](const std::vector<std::pair<TextureRole, AlphaMode>>& uses) {
    scene::Scene scene = scene_of({hidden_red()}, {});
    scene.materials.clear();
    for (const auto& [role, mode] : uses) {
      scene::SceneMaterial& material = scene.materials.emplace_back();
      material.alpha_mode = mode;
      material.textures.emplace_back().role = role;
      material.textures[0].blob = 0;
    }
    const auto images = ImageConverter(kPlenty).convert(scene, choice_of("resize:16"));
    return draw::decode_image(images->at(0).bytes)->texels.at(5);
  };
  constexpr std::uint32_t kPurple = 188U | 188U << 16U | 128U << 24U, kBlue = 255U << 16U | 128U << 24U;
  EXPECT_EQ(texel_of({{TextureRole::kBaseColor, AlphaMode::kOpaque}}), kPurple);
  EXPECT_EQ(texel_of({{TextureRole::kBaseColor, AlphaMode::kMask}}), kBlue);
  EXPECT_EQ(texel_of({{TextureRole::kBaseColor, AlphaMode::kOpaque}, {TextureRole::kBaseColor, AlphaMode::kBlend}}),
            kBlue);
  EXPECT_EQ(texel_of({{TextureRole::kEmissive, AlphaMode::kMask}}), kPurple) << "emission has no alpha";
}

TEST(ConvertImages, EveryImageOfATextureHasItsRole) {
  scene::Scene scene = scene_of({png(64), test::make_webp(64, 64, true, pixels_of(64, 4)), png(64)}, {});
  scene::TextureUse& use = scene.materials[0].textures.emplace_back();
  use.role = scene::TextureRole::kBaseColor;
  use.texture = 1;
  use.blob = 0;
  scene.document = R"({"textures": [{"source": 2}, {"source": 0, "extensions": {"EXT_texture_webp": {"source": 1}}}],
                       "images": [{"blob": 0}, {"blob": 1}, {"blob": 2}, {"blob": 9}]})";
  const auto images = ImageConverter(kPlenty).convert(scene, choice_of("resize:48"));
  ASSERT_TRUE(images);
  const auto fallback = draw::decode_image((*images)[0].bytes), webp = draw::decode_image((*images)[1].bytes),
             other = draw::decode_image((*images)[2].bytes);
  ASSERT_TRUE(fallback && webp && other);
  EXPECT_GT(psnr(*webp, *fallback), 25.0);
  const std::vector<std::uint8_t>& bytes = (*images)[1].bytes;
  EXPECT_NE(std::string(bytes.begin() + 12, bytes.begin() + 16), "VP8L") << "a colour is lossy";
  EXPECT_NE(other->texels, fallback->texels) << "the third is data";
}

TEST(ConvertImages, FewerTexelsKeepTheFormat) {
  const auto jpeg = test::make_jpeg(64, 64, 3, false, pixels_of(64, 3));
  const auto webp = test::make_webp(64, 64, true, pixels_of(64, 4));
  const auto scene = scene_of({png(64), jpeg, webp, png(16)}, {scene::TextureRole::kBaseColor});
  const auto images = ImageConverter(kPlenty).convert(scene, choice_of("resize:16"));
  ASSERT_TRUE(images);
  const char* const types[] = {"image/png", "image/jpeg", "image/webp"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ((*images)[i].mime_type, types[i]);
    const auto header = draw::read_image_header((*images)[i].bytes);
    ASSERT_TRUE(header);
    EXPECT_EQ(header->width, 16U);
    EXPECT_EQ(header->height, 16U);
  }
  EXPECT_TRUE((*images)[3].bytes.empty()) << "it is small enough";
  EXPECT_EQ((*images)[3].note, "");
}

TEST(ConvertImages, WhatCannotBeDecodedStaysAndIsNamed) {
  std::vector<std::uint8_t> cut = png(64);
  cut.resize(cut.size() / 2);
  const std::vector<std::uint8_t> ktx2{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n', 0, 0, 0, 0};
  const auto images = ImageConverter(kPlenty).convert(scene_of({cut, ktx2, {}, {'x'}}, {}), choice_of("webp"));
  ASSERT_TRUE(images);
  const char* const reasons[] = {"PNG", "KTX2", "neither PNG, JPEG nor WebP", "neither PNG, JPEG nor WebP"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE((*images)[i].bytes.empty());
    EXPECT_NE((*images)[i].note.find(reasons[i]), std::string::npos) << (*images)[i].note;
  }
}

TEST(ConvertImages, NothingBecomesLargerWithoutFewerTexels) {
  const auto jpeg = test::make_jpeg(64, 64, 3, false, pixels_of(64, 3));
  const auto images =
      ImageConverter(kPlenty).convert(scene_of({jpeg}, {scene::TextureRole::kNormal}), choice_of("webp"));
  ASSERT_TRUE(images);
  EXPECT_TRUE((*images)[0].bytes.empty());
  EXPECT_NE((*images)[0].note.find("would not be smaller"), std::string::npos) << (*images)[0].note;
}

/// A JPEG of quality 15 would triple at the quality of 90 that others get.
TEST(ConvertImages, FewerTexelsOfLowQualityTakeFewerBytes) {
  draw::DecodedImage picture;
  picture.width = picture.height = 128;
  for (std::uint32_t i = 0; i < 128 * 128; ++i) {
    const auto wave = static_cast<std::uint32_t>(128.0 + 60.0 * std::sin(i % 128 * 0.7) * std::cos(i / 128 * 0.9));
    picture.texels.push_back(0xFF000000U | wave << 16U | (i % 128 + wave / 4) << 8U | i / 128);
  }
  const auto jpeg = encode_jpeg_file(picture, 15);
  const auto webp = encode_webp_file(picture, 15);
  ASSERT_TRUE(jpeg && webp);
  struct Case {
    const std::vector<std::uint8_t>& source;
    const char *words, *type;
  };
  for (const auto& [source, words, type] : {Case{*jpeg, "resize:120", "image/jpeg"},
                                            {*jpeg, "resize:120,webp:100", "image/jpeg"},
                                            {*webp, "resize:120", "image/webp"}}) {
    const auto images =
        ImageConverter(kPlenty).convert(scene_of({source}, {scene::TextureRole::kBaseColor}), choice_of(words));
    ASSERT_TRUE(images);
    const builder::ConvertedImage& image = (*images)[0];
    EXPECT_EQ(image.mime_type, type);
    EXPECT_LT(image.bytes.size(), source.size()) << image.note;
    const auto before = draw::decode_image(source), after = draw::decode_image(image.bytes);
    ASSERT_TRUE(before && after);
    EXPECT_EQ(after->width, 120U);
    EXPECT_GT(psnr(shrink(*before, 120, 120, TexelKind::kOpaqueColor), *after), 25.0) << type;
  }
}

TEST(ConvertImages, WhatTakesMoreMemoryThanAllowedStaysAndIsNamed) {
  const auto images = ImageConverter(10'000).convert(scene_of({png(64), png(8)}, {}), choice_of("resize:4,webp"));
  ASSERT_TRUE(images);
  EXPECT_TRUE((*images)[0].bytes.empty());
  EXPECT_NE((*images)[0].note.find("--max-decoded"), std::string::npos) << (*images)[0].note;
  EXPECT_FALSE((*images)[1].bytes.empty());
}

TEST(ConvertImages, EncodersThatKeepEveryBitTakeMoreMemory) {
  constexpr std::uint64_t kTexels = 64 * 64;
  const auto fits = [](std::vector<std::uint8_t> image, const char* words, std::uint64_t most) {
    const auto images =
        ImageConverter(most).convert(scene_of({std::move(image)}, {scene::TextureRole::kBaseColor}), choice_of(words));
    return images.ok() && (*images)[0].note.find("--max-decoded") == std::string::npos;
  };
  const auto jpeg = test::make_jpeg(64, 64, 3, false, pixels_of(64, 3));
  EXPECT_TRUE(fits(png(64), "webp", 32 * kTexels));
  EXPECT_FALSE(fits(png(64), "webp", 32 * kTexels - 1));
  EXPECT_TRUE(fits(jpeg, "webp", 20 * kTexels)) << "lossy, and without alpha";
  EXPECT_FALSE(fits(jpeg, "webp", 20 * kTexels - 1));
}

TEST(ConvertImages, NotesNameWhatIsLost) {
  std::mt19937 random(5);
  std::vector<std::uint8_t> deep(2 * 64 * 64), bits(64 * 64 / 8);  // a bit a texel, of which the means are no bits
  for (std::uint8_t& byte : deep) byte = static_cast<std::uint8_t>(random());
  for (std::uint8_t& byte : bits) byte = static_cast<std::uint8_t>(random());
  const auto scene =
      scene_of({test::make_png(64, 64, {0, 16}, deep), test::make_png(64, 64, {0, 1}, bits), png(64)}, {});
  const auto images = ImageConverter(kPlenty).convert(scene, choice_of("resize:62"));
  ASSERT_TRUE(images);
  const auto has = [&](std::size_t i, const char* words) { return (*images)[i].note.find(words) != std::string::npos; };
  EXPECT_TRUE(has(0, "8 bits a channel instead of 16")) << (*images)[0].note;
  ASSERT_GT((*images)[1].bytes.size(), scene.blobs[1].bytes.size());
  EXPECT_TRUE(has(1, "more bytes for fewer texels")) << (*images)[1].note;
  EXPECT_FALSE(has(2, "8 bits") || has(2, "more bytes")) << (*images)[2].note;
}

TEST(ConvertImages, AreTheSameForAnyNumberOfThreads) {
  const auto scene = scene_of({png(64), png(33), png(50)}, {scene::TextureRole::kBaseColor});
  std::vector<std::vector<std::uint8_t>> first;
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto images = ImageConverter(kPlenty).convert(scene, choice_of("resize:20,webp"));
    ASSERT_TRUE(images);
    std::vector<std::vector<std::uint8_t>> bytes;
    for (const builder::ConvertedImage& image : *images) bytes.push_back(image.bytes);
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first);
  }
}

}  // namespace
}  // namespace meshlode::app
