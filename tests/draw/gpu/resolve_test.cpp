// SPDX-License-Identifier: GPL-3.0-or-later
// Colours from the visibility buffer, and cuts with attribute bounds.
#include <algorithm>
#include <cstdlib>
#include <optional>

#include <gtest/gtest.h>

#include "draw/gpu/pass_plan.h"
#include "draw/raster/legend.h"
#include "gpu_support.h"
#include "judge/gpu/compare_frame.h"
#include "support/mask_scene.h"
#include "support/sample_asset.h"

namespace meshlode::draw::test {
namespace {

using Resolve = GpuTest;

struct Opened {
  std::vector<std::uint8_t> bytes;
  std::optional<run::Asset> asset;
};

Opened open_file(const char* name) {
  Opened out;
  out.bytes = build_file(std::string(MESHLODE_DATA) + "/" + name);
  auto asset = run::Asset::from_vector(out.bytes);
  EXPECT_TRUE(asset);
  if (asset) out.asset = std::move(*asset);
  return out;
}

std::uint32_t level_count_of(const run::Asset& asset) {
  std::uint32_t count = 1;
  for (const format::MeshRecord& mesh : asset.meshes()) count = std::max(count, mesh.level_count);
  return count;
}

/// The CPU shades in doubles, the GPU in floats behind exact barycentrics: at most a step of 255, hardly anywhere more.
void expect_equal_colors(Device& device, const run::Asset& asset,
                         const std::vector<std::uint32_t>& views = {VIEW_SHADED, VIEW_CLUSTERS, VIEW_TRIANGLES,
                                                                    VIEW_LEVELS}) {
  auto scene = upload_scene(device, asset);
  ASSERT_TRUE(scene);
  const TextureSet textures = load_textures(asset);
  ASSERT_TRUE(upload_textures(device, textures, *scene));
  RendererOptions options{.width = 121, .height = 83, .frustum = false};
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = Renderer::make(device, *scene, options);
  ASSERT_TRUE(renderer);
  const std::vector<judge::NamedCamera> cameras = judge::adversarial_cameras(asset, 121, 83);
  for (const std::size_t which : {0U, 1U, 9U}) {  // around, behind, orthographic
    const run::Camera& camera = cameras[which].camera;
    const auto frame = judge::compare_frame(*renderer, asset, camera, 1.0);  // drawn in order, as the CPU's list is
    ASSERT_TRUE(frame) << frame.error().message();
    const auto cut = renderer->read_cut();
    ASSERT_TRUE(cut);
    const auto visibility = draw_cut(asset, *cut, camera, *scene->alpha_masks);
    ASSERT_TRUE(visibility);
    for (const std::uint32_t view : views) {
      auto got = renderer->resolve(view, level_count_of(asset));
      ASSERT_TRUE(got) << got.error().message();
      if (view == VIEW_LEVELS) draw_level_legend(got->image, level_count_of(asset));
      const auto want = shade_view(asset, *cut, camera, *visibility, static_cast<View>(view), textures);
      ASSERT_TRUE(want);
      ASSERT_EQ(got->image.rgba.size(), want->rgba.size());
      std::size_t off = 0;
      for (std::size_t i = 0; i < want->rgba.size(); ++i) {
        if (std::abs(int{want->rgba[i]} - int{got->image.rgba[i]}) > 1) ++off;
      }
      EXPECT_LE(off, want->rgba.size() / 2000) << cameras[which].name << ", view " << view;
    }
  }
}

TEST_F(Resolve, ColoursAreTheCpusUpToAStep) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  expect_equal_colors(*device_, *asset);
  const Opened city = open_file("city.glb");
  ASSERT_TRUE(city.asset);
  expect_equal_colors(*device_, *city.asset);
}

/// Base colour textures of every wrap mode, transformed, on masked materials; what resolves without them is another
/// picture.
TEST_F(Resolve, TexturesAreTheCpusUpToAStep) {
  meshlode::test::MaskSceneOptions options;
  options.transform = R"({"offset":[0.25,-0.5],"rotation":0.3,"scale":[2.7,-1.3]})";
  const auto asset = run::Asset::from_vector(meshlode::test::built(meshlode::test::mask_scene(options)));
  ASSERT_TRUE(asset);
  expect_equal_colors(*device_, *asset, {VIEW_SHADED});
  const Opened rock = open_file("rock.glb");
  ASSERT_TRUE(rock.asset);
  expect_equal_colors(*device_, *rock.asset, {VIEW_SHADED});

  auto scene = upload_scene(*device_, *rock.asset);
  ASSERT_TRUE(scene);
  EXPECT_TRUE(scene->has_textures);
  const run::Camera camera = judge::adversarial_cameras(*rock.asset, 121, 83)[0].camera;
  std::vector<std::uint8_t> pictures[2];
  for (const bool is_textured : {false, true}) {
    const auto plan = plan_passes(*scene, device_->info(), 121, 83, {}, is_textured);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->textures, is_textured);
    if (plan->textures) {
      ASSERT_TRUE(upload_textures(*device_, load_textures(*rock.asset), *scene));
    }
    auto renderer = Renderer::make(*device_, *scene, plan->options);
    ASSERT_TRUE(renderer);
    ASSERT_TRUE(renderer->draw(camera, 1.0, 0.0));
    const auto resolved = renderer->resolve(VIEW_SHADED, 1);
    ASSERT_TRUE(resolved);
    pictures[is_textured ? 1 : 0] = resolved->image.rgba;
  }
  std::size_t differ = 0;
  for (std::size_t i = 0; i < pictures[0].size(); ++i) differ += std::abs(pictures[0][i] - pictures[1][i]) > 20 ? 1 : 0;
  EXPECT_GT(differ, 1000U);
}

/// Base colours and normal maps of a real model.
TEST_F(Resolve, FlightHelmetsTexturesAreTheCpusUpToAStep) {
  const char* models = std::getenv("MESHLODE_MODELS");
  const char* required = std::getenv("MESHLODE_REQUIRE_MODELS");
  ASSERT_TRUE(models != nullptr || required == nullptr || std::string(required) != "1") << "MESHLODE_MODELS is not set";
  if (models == nullptr) GTEST_SKIP() << "MESHLODE_MODELS is not set";
  const auto asset = run::Asset::from_vector(build_file(std::string(models) + "/FlightHelmet/FlightHelmet.gltf"));
  ASSERT_TRUE(asset);
  const TextureSet textures = load_textures(*asset);
  EXPECT_TRUE(textures.warnings.empty());
  EXPECT_EQ(textures.images.size(), 10U) << "a base colour and a normal for each of five materials";
  expect_equal_colors(*device_, *asset, {VIEW_SHADED});
}

/// What the overdraw view counts: every pixel that is seen was drawn once at least, and nothing else was drawn.
TEST_F(Resolve, OverdrawIsThereExactlyWhereSomethingIsSeen) {
  const Opened city = open_file("city.glb");
  ASSERT_TRUE(city.asset);
  const auto scene = upload_scene(*device_, *city.asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 121, .height = 83};
  options.overdraw = true;
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer);
  ASSERT_TRUE(renderer->draw(judge::adversarial_cameras(*city.asset, 121, 83)[0].camera, 1.0, 0.0));
  const auto pixels = renderer->read_pixels();
  const auto picture = renderer->resolve(VIEW_OVERDRAW, 1);
  ASSERT_TRUE(pixels);
  ASSERT_TRUE(picture);
  std::size_t once = 0, often = 0;
  const std::uint8_t* background = nullptr;
  for (std::size_t i = 0; i < pixels->pixel_count(); ++i) {
    if (pixels->item[i] == VisibilityBuffer::kNothing) background = &picture->image.rgba[4 * i];
  }
  ASSERT_NE(background, nullptr);
  constexpr std::uint8_t kOnce[] = {57, 88, 221};  // to_display() of the ramp's first colour
  for (std::size_t i = 0; i < pixels->pixel_count(); ++i) {
    const std::uint8_t* color = &picture->image.rgba[4 * i];
    EXPECT_EQ(pixels->item[i] == VisibilityBuffer::kNothing, std::equal(color, color + 3, background)) << i;
    const bool is_once = std::equal(color, color + 3, kOnce);
    once += is_once ? 1 : 0;
    often += !is_once && pixels->item[i] != VisibilityBuffer::kNothing ? 1 : 0;
  }
  EXPECT_GT(once, 100U);
  EXPECT_GT(often, 10U);
}

/// `--normal-error` on the GPU: the cut of the flat rule with the same bounds, and a finer one than without.
TEST_F(Resolve, AttributeBoundsSelectWhatTheFlatRuleSelects) {
  const Opened rock = open_file("rock.glb");
  ASSERT_TRUE(rock.asset);
  run::AttributeBounds bounds;
  std::vector<double> deviations;
  for (const format::GroupRecord& group : rock.asset->groups()) {
    if (group.normal_deviation < format::kInfiniteError) deviations.push_back(double{group.normal_deviation});
  }
  ASSERT_FALSE(deviations.empty());
  std::sort(deviations.begin(), deviations.end());
  bounds.normal_degrees = deviations[deviations.size() / 2];
  const run::Camera camera = judge::adversarial_cameras(*rock.asset, 97, 64)[4].camera;
  std::size_t clusters[2] = {0, 0};
  for (const bool is_bound : {false, true}) {
    const run::AttributeBounds used = is_bound ? bounds : run::AttributeBounds{};
    const auto scene = upload_scene(*device_, *rock.asset, {}, used);
    ASSERT_TRUE(scene);
    auto renderer = Renderer::make(*device_, *scene, {.width = 97, .height = 64, .occlusion = true});
    ASSERT_TRUE(renderer);
    const auto result = judge::compare_frame(*renderer, *rock.asset, camera, 4.0, used);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->cut.differences + result->pixels.differences, 0U) << result->cut.first << result->pixels.first;
    clusters[is_bound ? 1 : 0] = result->frame.items;
  }
  EXPECT_GT(clusters[1], clusters[0]);
}

}  // namespace
}  // namespace meshlode::draw::test
