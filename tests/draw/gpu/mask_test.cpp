// SPDX-License-Identifier: GPL-3.0-or-later
// Alpha-masked materials: the GPU finds the CPU's texels, bit for bit, by every path of the rasterizer.
#include <cmath>
#include <span>

#include <gtest/gtest.h>

#include "draw/gpu/pass_plan.h"
#include "gpu_support.h"
#include "judge/gpu/compare_frame.h"
#include "support/mask_scene.h"

namespace meshlode::draw::test {
namespace {

using meshlode::test::MaskSceneOptions;
using Masks = GpuTest;

struct Size {
  std::uint32_t width, height;
};
constexpr Size kSizes[] = {{160, 90}, {97, 61}, {64, 192}};  // one of them odd
const std::span<const Size> kOddSize = std::span(kSizes).subspan(1, 1);

run::Asset open(const MaskSceneOptions& options) {
  auto asset = run::Asset::from_vector(meshlode::test::built(meshlode::test::mask_scene(options)));
  EXPECT_TRUE(asset) << (asset ? "" : asset.error().message());
  return std::move(asset).value();
}

/// Cameras that the adversarial ones are not: a card from so near that it is clipped, and along a card.
std::vector<judge::NamedCamera> cameras_of(const run::Asset& asset, Size size) {
  std::vector<judge::NamedCamera> out = judge::adversarial_cameras(asset, size.width, size.height);
  run::Camera near;
  near.width = size.width;
  near.height = size.height;
  near.eye = {-0.3, 0.2, 0.6};
  near.target = {1.0, 0.5, 0.0};
  near.near_distance = 0.2;
  out.push_back({"through a card", near});
  near.eye = {0.0, 0.0, 1.5};
  near.target = {0.05, 0.02, 0.0};
  out.push_back({"before a card", near});
  return out;
}

struct Drawn {
  std::uint64_t pixels = 0, covered = 0, clipped_items = 0, differences = 0;
};

Drawn compare(Device& device, const run::Asset& asset, RendererOptions options, std::span<const Size> sizes = kSizes,
              bool expect_equal = true) {
  Drawn out;
  const auto scene = upload_scene(device, asset);
  EXPECT_TRUE(scene);
  if (!scene) return out;
  options.width = kSizes[0].width;
  options.height = kSizes[0].height;
  options.double_sided = scene->has_double_sided;
  auto renderer = Renderer::make(device, *scene, options);
  EXPECT_TRUE(renderer) << (renderer ? "" : renderer.error().message());
  if (!renderer) return out;
  for (const Size size : sizes) {
    EXPECT_TRUE(renderer->resize(size.width, size.height));
    for (const judge::NamedCamera& named : cameras_of(asset, size)) {
      const auto result = judge::compare_frame(*renderer, asset, named.camera, 0.7);
      EXPECT_TRUE(result) << (result ? "" : result.error().message());
      if (!result) continue;
      out.pixels += result->pixels.items;
      out.clipped_items += result->frame.clipped_items;
      out.differences += result->pixels.differences;
      const auto pixels = renderer->read_pixels();
      EXPECT_TRUE(pixels);
      for (const std::uint32_t item : pixels->item) out.covered += item != VisibilityBuffer::kNothing ? 1 : 0;
      if (!expect_equal) continue;
      EXPECT_EQ(result->cut.differences, 0U) << named.name << " at " << size.width << ": " << result->cut.first;
      EXPECT_EQ(result->pixels.differences, 0U) << named.name << " at " << size.width << ": " << result->pixels.first;
    }
  }
  return out;
}

TEST_F(Masks, EveryWrapModeIsTheCpusBitForBit) {
  const Drawn drawn = compare(*device_, open({}), {.frustum = false, .alpha_mask = true});
  EXPECT_GT(drawn.covered, drawn.pixels / 20);
  EXPECT_GT(drawn.clipped_items, 0U) << "a masked triangle across the near plane";
}

TEST_F(Masks, TransformsFactorsAndVertexAlphaAreTheCpusBitForBit) {
  MaskSceneOptions options;
  options.has_vertex_alpha = true;
  options.factor = 0.83F;
  options.cutoff = 0.21F;
  options.transform = R"({"offset":[0.25,-0.5],"rotation":0.3,"scale":[2.7,-1.3]})";
  const Drawn drawn = compare(*device_, open(options), {.frustum = true, .occlusion = true, .alpha_mask = true});
  EXPECT_GT(drawn.covered, drawn.pixels / 20);
}

TEST_F(Masks, WithoutTheTestThePictureIsAnother) {
  const Drawn drawn = compare(*device_, open({}), {.frustum = false, .alpha_mask = false}, kOddSize, false);
  EXPECT_GT(drawn.differences, 1000U);
}

TEST_F(Masks, CutoffsAtTheEnds) {
  MaskSceneOptions options;
  options.cutoff = 0.0F;
  const run::Asset all = open(options);
  const auto scene = upload_scene(*device_, all);
  ASSERT_TRUE(scene);
  EXPECT_FALSE(scene->has_alpha_mask) << "what always passes needs no test";
  const auto plan = plan_passes(*scene, device_->info(), 64, 64);
  ASSERT_TRUE(plan);
  EXPECT_FALSE(plan->options.alpha_mask);
  const auto forced = plan_passes(*scene, device_->info(), 64, 64, {"alpha-mask"});
  ASSERT_TRUE(forced);
  EXPECT_TRUE(forced->options.alpha_mask);
  compare(*device_, all, forced->options, kOddSize);  // the test runs and every sample passes

  options.cutoff = 1.5F;  // nothing passes
  const Drawn wall_only = compare(*device_, open(options), {.frustum = false, .alpha_mask = true}, kOddSize);
  options.cutoff = 1.0F;  // texels of 255 pass
  const Drawn few = compare(*device_, open(options), {.frustum = false, .alpha_mask = true}, kOddSize);
  EXPECT_GE(few.covered, wall_only.covered);
}

TEST_F(Masks, AMissingImageIsOpaqueOnBothSides) {
  MaskSceneOptions options;
  options.image = {1, 2, 3};
  const run::Asset asset = open(options);
  const auto scene = upload_scene(*device_, asset);
  ASSERT_TRUE(scene);
  EXPECT_FALSE(scene->alpha_masks->warnings.empty());
  const Drawn opaque = compare(*device_, asset, {.frustum = false, .alpha_mask = true}, kOddSize);
  EXPECT_GT(opaque.covered, compare(*device_, open({}), {.frustum = false, .alpha_mask = true}, kOddSize).covered);
}

/// Far roots have a rasterizer of their own, which has its own test.
TEST_F(Masks, FarRootsAreTheCpusBitForBit) {
  MaskSceneOptions options;
  options.cells = 1;  // a mesh of 18 triangles: one cluster, its own root
  const run::Asset asset = open(options);
  const auto scene = upload_scene(*device_, asset);
  ASSERT_TRUE(scene);
  RendererOptions renderer_options{.width = 61, .height = 40, .frustum = false, .alpha_mask = true};
  renderer_options.double_sided = true;
  auto renderer = Renderer::make(*device_, *scene, renderer_options);
  ASSERT_TRUE(renderer);
  renderer_options.alpha_mask = false;
  auto opaque = Renderer::make(*device_, *scene, renderer_options);
  ASSERT_TRUE(opaque);
  std::uint64_t far_items = 0, differences_without = 0;
  for (int i = 0; i < 60; ++i) {
    run::Camera camera;
    camera.width = 61;
    camera.height = 40;
    const double turn = 2.399963229728653 * i, distance = 25.0 + 4.0 * (i % 20);
    camera.eye = distance * Vec3d(0.6 * std::sin(turn), 0.3 * std::cos(3.0 * turn), 1.0);
    camera.target = 0.1 * distance * Vec3d(std::sin(3.0 * turn), std::cos(7.0 * turn), 0.0);
    camera.near_distance = 0.1;
    camera.is_orthographic = i % 5 == 0;
    camera.ortho_height = 0.9 * distance;
    const auto result = judge::compare_frame(*renderer, asset, camera, 1.0);
    ASSERT_TRUE(result) << result.error().message();
    EXPECT_EQ(result->pixels.differences, 0U) << i << ": " << result->pixels.first;
    far_items += result->frame.far_items;
    if (result->frame.far_items == 0) continue;
    const auto without = judge::compare_frame(*opaque, asset, camera, 1.0);
    ASSERT_TRUE(without);
    differences_without += without->pixels.differences;
  }
  EXPECT_GT(far_items, 20U);
  EXPECT_GT(differences_without, 20U);
}

/// Reproducer: amid the leaves some thousand pixels belong to clipped triangles of one cluster, and Mesa's lavapipe
/// ends the loops of an invocation after 65,535 iterations. Walking along strips again and again for each triangle used
/// them up.
TEST_F(Masks, ClippedLeavesAreDrawnToTheEnd) {
  const std::vector<std::uint8_t> bytes = build_file(MESHLODE_DATA "/foliage.glb");
  const auto asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 640, .height = 360, .frustum = false, .double_sided = true, .alpha_mask = true};
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer);
  const judge::NamedCamera inside = judge::adversarial_cameras(*asset, 640, 360)[2];
  ASSERT_EQ(inside.name, "inside");
  const auto result = judge::compare_frame(*renderer, *asset, inside.camera, 1.0);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_EQ(result->pixels.differences, 0U) << result->pixels.first;
  EXPECT_GT(result->frame.clipped_items, 10U);
}

TEST_F(Masks, TheHardwareCutsTheSameHoles) {
  const run::Asset asset = open({});
  const auto scene = upload_scene(*device_, asset);
  ASSERT_TRUE(scene);
  for (const HardwarePath path : {HardwarePath::kVertex, HardwarePath::kMesh}) {
    if (path == HardwarePath::kMesh && !device_->info().has_mesh_shaders) continue;
    std::uint64_t differences[2] = {0, 0};
    for (const bool is_masked : {false, true}) {
      RendererOptions options{.width = 320, .height = 240, .frustum = false, .double_sided = true};
      options.alpha_mask = is_masked;
      options.hardware = path;
      options.hardware_pixels = 0.0F;
      auto renderer = Renderer::make(*device_, *scene, options);
      ASSERT_TRUE(renderer) << renderer.error().message();
      for (const std::size_t which : {0U, 9U}) {
        const run::Camera camera = judge::adversarial_cameras(asset, 320, 240)[which].camera;
        const auto result = judge::compare_hardware(*renderer, asset, camera, 1.0);
        ASSERT_TRUE(result) << result.error().message();
        differences[is_masked ? 1 : 0] += result->picture.differing;
        EXPECT_TRUE(result->is_same_cut);
        EXPECT_GT(result->picture.covered, 0U);
        EXPECT_TRUE(!is_masked || result->picture.is_within_bounds()) << judge::describe(result->picture);
      }
    }
    EXPECT_GT(differences[0], 500U);
  }
}

}  // namespace
}  // namespace meshlode::draw::test
