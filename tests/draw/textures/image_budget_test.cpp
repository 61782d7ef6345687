// SPDX-License-Identifier: GPL-3.0-or-later
// What decoded images may take: a few kilobytes of PNG hold hundreds of millions of texels.
#include "draw/textures/image_budget.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <numeric>

#include <gtest/gtest.h>

#include "draw/textures/alpha_mask.h"
#include "draw/textures/image_samples.h"
#include "draw/textures/texture_set.h"
#include "support/mask_scene.h"

namespace meshlode::draw {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The mask scene; all its cards share one image as base colour and as mask.
run::Asset scene_with(Bytes image) {
  test::MaskSceneOptions options;
  options.image = std::move(image);
  auto asset = run::Asset::from_vector(test::built(test::mask_scene(options)));
  EXPECT_TRUE(asset);
  return std::move(asset).value();
}

Bytes grey_png(std::uint32_t side) {
  return test::make_png(side, side, {.color_type = 0}, Bytes(std::size_t{side} * side, 77));
}

TEST(ImageBudget, TakesWhatThereIsAndGivesItBack) {
  ImageBudget budget(10);
  EXPECT_FALSE(budget.take(11));
  EXPECT_EQ(budget.left(), 10u);
  EXPECT_TRUE(budget.take(7));
  EXPECT_FALSE(budget.take(4));
  budget.give_back(5);
  EXPECT_TRUE(budget.take(8));
  EXPECT_EQ(budget.left(), 0u);
  EXPECT_FALSE(budget.take(UINT64_MAX)) << "no sum overflows";
}

TEST(ImageBudget, AnImageThatIsNotWhatWasWrittenIsDamageAndNoWarning) {
  test::MaskSceneOptions options;
  options.image = grey_png(64);
  Bytes bytes = test::built(test::mask_scene(options));
  const auto whole = run::Asset::from_vector(Bytes(bytes));
  ASSERT_TRUE(whole);
  EXPECT_TRUE(load_textures(*whole).damage);
  EXPECT_TRUE(load_alpha_masks(*whole).damage);
  const format::BlobRecord& blob = whole->blobs()[0];
  bytes[blob.offset + blob.bytes - 1] ^= 1U;  // of the last chunk's checksum: it may well be decoded
  const auto damaged = run::Asset::from_vector(std::move(bytes));
  ASSERT_TRUE(damaged);
  const TextureSet textures = load_textures(*damaged);
  ASSERT_FALSE(textures.damage);
  EXPECT_EQ(textures.damage.error().code, ErrorCode::kInvalid);
  EXPECT_EQ(textures.damage.error().message(), "blob 0, field checksum: does not match the stored bytes");
  EXPECT_TRUE(textures.images.empty());
  EXPECT_TRUE(textures.warnings.empty());
  EXPECT_FALSE(load_alpha_masks(*damaged).damage);
}

TEST(ImageBudget, ATextureIsLoadedWithItsLevelsOrNotAtAll) {
  const run::Asset asset = scene_with(grey_png(64));
  const std::uint64_t texels = 64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1;
  EXPECT_EQ(count_mip_texels(64, 64), texels);
  ImageBudget enough(4 * texels);
  const TextureSet loaded = load_textures(asset, enough);
  ASSERT_EQ(loaded.images.size(), 1u);
  EXPECT_EQ(loaded.images[0].texels.size(), texels);
  EXPECT_EQ(loaded.images[0].texels.capacity(), texels) << "room is made once";
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(enough.left(), 0u);

  ImageBudget short_by_one(4 * texels - 1);
  const TextureSet refused = load_textures(asset, short_by_one);
  EXPECT_TRUE(refused.images.empty());
  ASSERT_EQ(refused.warnings.size(), 1u) << "one line for nine materials";
  for (const char* part : {"mask.png", "64 x 64", "21.4KiB", "--max-decoded", "not drawn"}) {
    EXPECT_NE(refused.warnings[0].find(part), std::string::npos) << part << " in: " << refused.warnings[0];
  }
  EXPECT_EQ(short_by_one.left(), 4 * texels - 1);
  for (const SampledMaterial& material : refused.materials) EXPECT_FALSE(material.base_color);
}

TEST(ImageBudget, MasksAndTexturesShareIt) {
  Bytes rows(std::size_t{4} * 64 * 64);
  std::iota(rows.begin(), rows.end(), std::uint8_t{0});
  const run::Asset asset = scene_with(test::make_png(64, 64, {.color_type = 6}, rows));
  const std::uint64_t mask = 64 * 64, texture = 4 * count_mip_texels(64, 64);
  ImageBudget both(mask + texture);
  const AlphaMasks masks = load_alpha_masks(asset, both);
  ASSERT_EQ(masks.images.size(), 1u);
  EXPECT_EQ(masks.images[0].texels.size(), mask);
  EXPECT_EQ(both.left(), texture) << "what decoding took beside the alpha is given back";
  EXPECT_EQ(load_textures(asset, both).images.size(), 1u);

  ImageBudget only_masks(mask + texture - 1);
  EXPECT_TRUE(load_alpha_masks(asset, only_masks).warnings.empty());
  EXPECT_TRUE(load_textures(asset, only_masks).images.empty());

  ImageBudget none(5 * 64 * 64 - 1);
  const AlphaMasks opaque = load_alpha_masks(asset, none);
  ASSERT_EQ(opaque.warnings.size(), 1u);
  EXPECT_NE(opaque.warnings[0].find("drawn opaque"), std::string::npos) << opaque.warnings[0];
  for (const AlphaMask& m : opaque.masks) EXPECT_EQ(m.image, format::kNone);
}

TEST(ImageBudget, CoefficientsOfAProgressiveJpegCount) {
  const Bytes pixels(std::size_t{3} * 100 * 40, 99);
  const auto plain = read_image_header(test::make_jpeg(100, 40, 3, false, pixels));
  const auto progressive = read_image_header(test::make_jpeg(100, 40, 3, true, pixels));
  ASSERT_TRUE(plain && progressive);
  EXPECT_EQ(plain->decoder_bytes, 0u);
  EXPECT_GE(progressive->decoder_bytes, 2u * 3 * 104 * 40);
  EXPECT_LE(progressive->decoder_bytes, 2u * 3 * 128 * 64);
  const run::Asset asset = scene_with(test::make_jpeg(100, 40, 3, true, pixels));
  const std::uint64_t bytes = 4 * count_mip_texels(100, 40) + progressive->decoder_bytes;
  ImageBudget enough(bytes), short_by_one(bytes - 1);
  EXPECT_EQ(load_textures(asset, enough).images.size(), 1u);
  EXPECT_EQ(enough.left(), progressive->decoder_bytes) << "the texels stay";
  EXPECT_TRUE(load_textures(asset, short_by_one).images.empty());
}

/// The largest resident size of a child that runs `body`, MiB.
template <class Body>
long peak_of(const Body& body) {
  const pid_t child = fork();
  if (child == 0) {
    body();
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  return usage.ru_maxrss / 1024;
}

// 16384 × 16384 texels of one bit in 33 KB: 1.4 GiB with their levels, and rendering took 2.5 GB for them.
TEST(ImageBudget, AFewKilobytesDoNotTakeGigabytes) {
  const std::uint32_t side = 16384;
  const Bytes png =
      test::make_png(side, side, {.color_type = 0, .bit_depth = 1}, Bytes(std::size_t{side} * side / 8, 0));
  ASSERT_LT(png.size(), 50000u);
  const run::Asset asset = scene_with(png);
  const long before = peak_of([] {});
  const long peak = peak_of([&] {
    ImageBudget budget;
    if (!load_alpha_masks(asset, budget).images.at(0).texels.empty() || !load_textures(asset, budget).is_empty())
      abort();
  });
  EXPECT_LT(peak - before, 64) << "MiB";
}

TEST(ImageBudget, DecodingTakesWhatItIsCountedAs) {
  const std::uint32_t side = 4096;
  const Bytes png =
      test::make_png(side, side, {.color_type = 0, .bit_depth = 1}, Bytes(std::size_t{side} * side / 8, 0));
  const run::Asset asset = scene_with(png);
  const std::uint64_t counted = 4 * count_mip_texels(side, side);
  const long before = peak_of([] {});
  const long peak = peak_of([&] {
    ImageBudget budget(counted);
    if (load_textures(asset, budget).images.size() != 1) abort();
  });
  EXPECT_LT(peak - before, static_cast<long>(counted >> 20u) + 32) << "MiB; twice as much before";
}

}  // namespace
}  // namespace meshlode::draw
