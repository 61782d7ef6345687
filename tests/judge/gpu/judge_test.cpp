// SPDX-License-Identifier: GPL-3.0-or-later
// I8 and I9 on small scenes: the GPU decodes, selects and draws what the CPU does, bit for bit.
#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "draw/gpu/gpu_camera.h"
#include "draw/gpu/gpu_support.h"
#include "draw/raster/projection.h"
#include "judge/gpu/compare_frame.h"
#include "judge/pictures/id_picture.h"
#include "support/sample_asset.h"

namespace meshlode::judge::test {
namespace {

using Judge = draw::test::GpuTest;

run::Asset open(const std::vector<std::uint8_t>& bytes) {
  auto asset = run::Asset::from_vector(bytes);
  EXPECT_TRUE(asset) << (asset ? "" : asset.error().message());
  return std::move(asset).value();
}

struct Size {
  std::uint32_t width, height;
};
constexpr Size kSizes[] = {{160, 90}, {97, 61}, {256, 256}};

void expect_equal_frames(draw::Device& device, const run::Asset& asset, draw::RendererOptions options) {
  auto scene = draw::upload_scene(device, asset);
  ASSERT_TRUE(scene) << scene.error().message();
  options.width = kSizes[0].width;
  options.height = kSizes[0].height;
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = draw::Renderer::make(device, *scene, options);
  ASSERT_TRUE(renderer) << renderer.error().message();
  for (const Size size : kSizes) {
    ASSERT_TRUE(renderer->resize(size.width, size.height));
    for (const NamedCamera& named : adversarial_cameras(asset, size.width, size.height)) {
      for (const double pixel_error : {0.5, 4.0}) {
        SCOPED_TRACE(named.name + " at " + std::to_string(pixel_error) + " px, " + std::to_string(size.width) + "x" +
                     std::to_string(size.height));
        const auto result = compare_frame(*renderer, asset, named.camera, pixel_error);
        ASSERT_TRUE(result) << result.error().message();
        EXPECT_EQ(result->cut.differences, 0U) << result->cut.first;
        EXPECT_EQ(result->pixels.differences, 0U) << result->pixels.first;
        EXPECT_GT(result->cut.items, 0U);
      }
    }
  }
}

TEST_F(Judge, DecodesEveryIntegerAsTheCpuDoes) {
  const run::Asset asset = open(meshlode::test::sample_asset_bytes());
  const auto scene = draw::upload_scene(*device_, asset);
  ASSERT_TRUE(scene) << scene.error().message();
  const auto result = compare_decode(*device_, *scene, asset);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_EQ(result->differences, 0U) << result->first;
  EXPECT_EQ(result->items, asset.clusters().size());
}

// Every float and double that an instance is given on the GPU has the bits that the CPU gives it.
TEST_F(Judge, InstancesGetTheBitsOfTheCpu) {
  const run::Asset asset = open(meshlode::test::sample_asset_bytes());
  auto scene = draw::upload_scene(*device_, asset);
  ASSERT_TRUE(scene) << scene.error().message();
  auto renderer = draw::Renderer::make(*device_, *scene, {.width = 97, .height = 61, .frustum = false});
  ASSERT_TRUE(renderer) << renderer.error().message();
  for (const NamedCamera& named : adversarial_cameras(asset, 97, 61)) {
    SCOPED_TRACE(named.name);
    auto projection = draw::make_projection(named.camera);
    ASSERT_TRUE(projection);
    projection->far_distance = draw::scene_depth(asset, *projection);
    ASSERT_TRUE(renderer->draw(named.camera, 0.7, projection->far_distance));
    const auto visible = renderer->read_visible();
    ASSERT_TRUE(visible);
    EXPECT_EQ(visible->size(), 4U) << "all but the empty mesh and the singular instance";
    for (const draw::GpuVisible& v : *visible) {
      const format::InstanceRecord& instance = asset.instances()[v.instance];
      const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
      const run::MetricView view =
          run::make_metric_view(named.camera, 0.7, instance, mesh, run::mesh_reach(run::tables_of(asset), mesh));
      // NOLINTBEGIN(bugprone-suspicious-memory-comparison): the same bits are promised.
      EXPECT_EQ(std::memcmp(&view, &v.view, sizeof view), 0) << "view of instance " << v.instance;
      const draw::GridToClip clip = draw::make_grid_to_clip(*projection, mesh, instance);
      EXPECT_EQ(std::memcmp(&clip, v.clip, sizeof v.clip), 0) << "rows of instance " << v.instance;
      // NOLINTEND(bugprone-suspicious-memory-comparison)
    }
  }
}

TEST_F(Judge, DrawsTheSampleSceneAsTheCpuDoes) {
  const run::Asset asset = open(meshlode::test::sample_asset_bytes());
  expect_equal_frames(*device_, asset, {.width = 0, .height = 0, .frustum = false});
}

/// What a pixel shows, by its mesh and its material, is the same of either picture: meshes of several materials, many
/// instances, cuts of many clusters.
TEST_F(Judge, ShowsTheSurfacesThatTheCpuShows) {
  const run::Asset asset = open(draw::test::build_file(MESHLODE_DATA "/city.glb"));
  const auto scene = draw::upload_scene(*device_, asset);
  ASSERT_TRUE(scene) << scene.error().message();
  auto renderer = draw::Renderer::make(
      *device_, *scene, {.width = 160, .height = 120, .frustum = false, .double_sided = scene->has_double_sided});
  ASSERT_TRUE(renderer) << renderer.error().message();
  const IdPainter painter(asset);
  const std::vector<NamedCamera> cameras = adversarial_cameras(asset, 160, 120);
  for (const std::size_t i : {0, 1, 7, 9}) {
    const NamedCamera& named = cameras[i];
    SCOPED_TRACE(named.name);
    const auto depth = draw::depth_of_scene(asset, named.camera);
    ASSERT_TRUE(depth && renderer->draw(named.camera, 3.0, *depth) && renderer->redraw_in_order());
    const auto cut = renderer->read_cut();
    const auto pixels = renderer->read_pixels();
    ASSERT_TRUE(cut && pixels);
    const std::vector<run::ClusterInstance> flat = run::select_flat(asset, named.camera, 3.0);
    const auto drawn = draw::draw_cut(asset, flat, named.camera);
    ASSERT_TRUE(drawn);
    const auto by_gpu = painter.of_cut(*cut, *pixels), by_cpu = painter.of_cut(flat, *drawn);
    ASSERT_TRUE(by_gpu && by_cpu);
    EXPECT_EQ(by_gpu->id, by_cpu->id);
    EXPECT_EQ(by_gpu->depth, by_cpu->depth);
    EXPECT_EQ(by_gpu->level0, by_cpu->level0);
    EXPECT_TRUE(std::any_of(by_gpu->id.begin(), by_gpu->id.end(),
                            [](std::uint64_t id) { return id != IdPicture::kBackground; }));
  }
}

TEST_F(Judge, CullingChangesNoPixelOfTheSampleScene) {
  const run::Asset asset = open(meshlode::test::sample_asset_bytes());
  expect_equal_frames(*device_, asset, {.width = 0, .height = 0, .frustum = true, .occlusion = true});
}

}  // namespace
}  // namespace meshlode::judge::test
