// SPDX-License-Identifier: GPL-3.0-or-later
// I8 and I9 over whole scenes, and tests in which the judge must find something.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>

#include "draw/gpu/pass_plan.h"
#include "gpu_support.h"
#include "judge/gpu/compare_frame.h"
#include "judge/pictures/cameras.h"
#include "support/sample_asset.h"

namespace meshlode::draw::test {
namespace {

using Scenes = GpuTest;

void expect_equal(Device& device, const run::Asset& asset, std::uint32_t orbits) {
  auto scene = upload_scene(device, asset);
  ASSERT_TRUE(scene) << scene.error().message();
  const auto decode = judge::compare_decode(device, *scene, asset);
  ASSERT_TRUE(decode) << decode.error().message();
  EXPECT_EQ(decode->differences, 0U) << decode->first;
  RendererOptions options;
  options.width = 192;
  options.height = 108;
  options.occlusion = true;
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = Renderer::make(device, *scene, options);
  ASSERT_TRUE(renderer) << renderer.error().message();
  constexpr std::uint32_t kSizes[][2] = {{192, 108}, {131, 77}, {64, 200}};
  for (const auto& [width, height] : kSizes) {
    ASSERT_TRUE(renderer->resize(width, height));
    std::vector<judge::NamedCamera> cameras = judge::adversarial_cameras(asset, width, height);
    for (const judge::NamedCamera& named : judge::orbit_cameras(asset, orbits, width, height)) cameras.push_back(named);
    for (const judge::NamedCamera& named : cameras) {
      SCOPED_TRACE(named.name + " at " + std::to_string(width) + "x" + std::to_string(height));
      const auto result = judge::compare_frame(*renderer, asset, named.camera, 1.0);
      ASSERT_TRUE(result) << result.error().message();
      EXPECT_EQ(result->cut.differences, 0U) << result->cut.first;
      EXPECT_EQ(result->pixels.differences, 0U) << result->pixels.first;
    }
  }
}

void expect_equal_file(Device& device, const std::string& path, std::uint32_t orbits) {
  const std::vector<std::uint8_t> bytes = build_file(path);
  ASSERT_FALSE(bytes.empty());
  const auto asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset) << asset.error().message();
  expect_equal(device, *asset, orbits);
}

TEST_F(Scenes, TheCityIsDrawnAsTheCpuDrawsIt) {
  expect_equal_file(*device_, MESHLODE_DATA "/city.glb", 2);
}
TEST_F(Scenes, FoliageIsDrawnAsTheCpuDrawsIt) {
  expect_equal_file(*device_, MESHLODE_DATA "/foliage.glb", 2);
}

class Models : public GpuTest, public testing::WithParamInterface<const char*> {};
TEST_P(Models, AreDrawnAsTheCpuDrawsThem) {
  const char* models = std::getenv("MESHLODE_MODELS");
  const char* required = std::getenv("MESHLODE_REQUIRE_MODELS");
  ASSERT_TRUE(models != nullptr || required == nullptr || std::string(required) != "1") << "MESHLODE_MODELS is not set";
  if (models == nullptr) GTEST_SKIP() << "MESHLODE_MODELS is not set";
  expect_equal_file(*device_, std::string(models) + "/" + GetParam(), 2);
}
INSTANTIATE_TEST_SUITE_P(All, Models, testing::Values("bunny.glb", "FlightHelmet/FlightHelmet.gltf"));

/// The judge must see one changed bit of a page.
TEST_F(Scenes, AChangedPageBitIsFound) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  std::vector<std::uint8_t> pages(scene->page_bytes);
  ASSERT_TRUE(device_->download(scene->pages, pages));
  pages[pages.size() / 2] ^= 1U;
  ASSERT_TRUE(device_->upload(scene->pages, pages));
  const auto result = judge::compare_decode(*device_, *scene, *asset);
  ASSERT_TRUE(result);
  EXPECT_GT(result->differences, 0U);
}

/// A group error that is a little larger on the GPU alone changes some cut, and the judge sees it.
TEST_F(Scenes, AChangedGroupErrorIsFound) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  std::vector<GpuGroup> groups(asset->groups().size());
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(groups.data()), groups.size() * sizeof(GpuGroup));
  ASSERT_TRUE(device_->download(scene->groups, bytes));
  for (GpuGroup& group : groups) group.error = 0.0F;  // passes always, also where its leaf says that it is open
  ASSERT_TRUE(device_->upload(scene->groups, bytes));
  auto renderer = Renderer::make(
      *device_, *scene, {.width = 96, .height = 64, .frustum = false, .double_sided = true, .alpha_mask = true});
  ASSERT_TRUE(renderer);
  std::uint64_t differences = 0;
  for (const judge::NamedCamera& named : judge::orbit_cameras(*asset, 6, 96, 64)) {
    const auto result = judge::compare_frame(*renderer, *asset, named.camera, 2.0);
    ASSERT_TRUE(result) << result.error().message();
    differences += result->cut.differences + result->pixels.differences;
  }
  EXPECT_GT(differences, 0U);
}

/// Culling spheres that are too small drop what should be seen, and the judge sees the holes.
TEST_F(Scenes, TooSmallCullingSpheresAreFound) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  std::vector<GpuCluster> clusters(asset->clusters().size());
  const std::span<std::uint8_t> bytes(reinterpret_cast<std::uint8_t*>(clusters.data()),
                                      clusters.size() * sizeof(GpuCluster));
  ASSERT_TRUE(device_->download(scene->clusters, bytes));
  for (GpuCluster& cluster : clusters) {
    cluster.radius = 0.0F;
    for (float& c : cluster.center) c *= 50.0F;
  }
  ASSERT_TRUE(device_->upload(scene->clusters, bytes));
  auto renderer =
      Renderer::make(*device_, *scene, {.width = 96, .height = 64, .double_sided = true, .alpha_mask = true});
  ASSERT_TRUE(renderer);
  const auto result = judge::compare_frame(*renderer, *asset, judge::orbit_cameras(*asset, 1, 96, 64)[0].camera, 1.0);
  ASSERT_TRUE(result);
  EXPECT_GT(result->pixels.differences, 0U);
}

TEST_F(Scenes, AListThatOverflowsSaysSo) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  const std::vector<format::InstanceRecord> many(200, asset->instances()[0]);
  const auto crowd = upload_scene(*device_, *asset, many);
  ASSERT_TRUE(crowd);
  RendererOptions options{.width = 96, .height = 64, .frustum = false};
  options.max_items = 64;
  auto renderer = Renderer::make(*device_, *crowd, options);
  ASSERT_TRUE(renderer);
  const auto frame = renderer->draw(judge::orbit_cameras(*asset, 1, 96, 64)[0].camera, 0.5, 0.0);
  ASSERT_TRUE(frame);
  EXPECT_NE(frame->overflow, 0U);
  EXPECT_NE(describe_overflow(frame->overflow), "");
}

/// One dispatch with a queue, in the second round or in both, opens the same groups as the CPU's flat rule, which are
/// those of one dispatch a depth too.
TEST_F(Scenes, EveryTraversalOpensTheGroupsOfTheFlatRule) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  struct Case {
    bool occlusion, persistent;
  };
  for (const Case c : {Case{false, false}, Case{false, true}, Case{true, true}, Case{true, false}}) {
    SCOPED_TRACE(testing::Message() << c.occlusion << c.persistent);
    RendererOptions options{.width = 97, .height = 64, .frustum = c.occlusion, .occlusion = c.occlusion};
    options.double_sided = options.alpha_mask = true;
    options.persistent = c.persistent;
    auto renderer = Renderer::make(*device_, *scene, options);
    ASSERT_TRUE(renderer);
    for (const judge::NamedCamera& named : judge::orbit_cameras(*asset, 6, 97, 64)) {
      // So fine that no instance is far: those go past the BVH.
      const auto result = judge::compare_frame(*renderer, *asset, named.camera, 0.1);
      ASSERT_TRUE(result);
      EXPECT_EQ(result->cut.differences + result->pixels.differences, 0U) << result->cut.first << result->pixels.first;
      EXPECT_GT(result->frame.traversed_nodes, 0U);
    }
  }
}

/// Hardware raster draws what is near to the CPU's picture; and the judge finds another one.
TEST_F(Scenes, HardwareRasterHoldsAndItsJudgeCanFail) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 640, .height = 360, .frustum = false, .double_sided = true, .alpha_mask = true};
  options.hardware = HardwarePath::kVertex;
  options.hardware_pixels = 0.0F;
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer);
  options.double_sided = false;
  auto one_sided = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(one_sided);
  std::uint64_t found = 0, differing = 0, covered = 0;
  std::vector<judge::NamedCamera> cameras = judge::orbit_cameras(*asset, 4, 640, 360);
  for (const judge::NamedCamera& named : judge::adversarial_cameras(*asset, 640, 360)) cameras.push_back(named);
  for (const judge::NamedCamera& named : cameras) {
    SCOPED_TRACE(named.name);
    const auto result = judge::compare_hardware(*renderer, *asset, named.camera, 1.0);
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->is_same_cut);
    EXPECT_TRUE(result->picture.is_within_bounds()) << judge::describe(result->picture);
    covered += result->picture.covered;
    const auto other = judge::compare_hardware(*one_sided, *asset, named.camera, 1.0);
    ASSERT_TRUE(other);
    found += other->picture.is_within_bounds() ? 0 : 1;
    differing += other->picture.differing;
  }
  EXPECT_GT(covered, 100000U);
  EXPECT_GT(differing, 1000U) << "the sample is double-sided in part, and the other culls";
  EXPECT_GE(found, 2U) << "frames of which a back is a large part";
}

/// From far away a mesh's root alone is open: then its instance goes past the hierarchy, to the same cut.
TEST_F(Scenes, AFarInstanceIsNotTraversed) {
  const std::vector<std::uint8_t> bytes = build_file(MESHLODE_DATA "/rock.glb");
  ASSERT_FALSE(bytes.empty());
  const auto asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 97, .height = 64, .frustum = false};
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer);
  const run::Camera camera = judge::adversarial_cameras(*asset, 97, 64)[4].camera;
  for (const bool is_far : {false, true}) {
    // The root passes at eight pixels; half a thousandth of one opens finer groups, and the instance is traversed.
    const auto result = judge::compare_frame(*renderer, *asset, camera, is_far ? 8.0 : 0.0005);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->cut.differences + result->pixels.differences, 0U) << result->cut.first << result->pixels.first;
    EXPECT_EQ(result->frame.traversed_nodes == 0, is_far);
    EXPECT_EQ(result->frame.far_items, is_far ? 1U : 0U);
  }
}

/// Roots of a few pixels have a rasterizer of their own, which must give the same bits: at many places of the picture
/// and its border, at every size up to its largest, mirrored and stretched, orthographic too.
TEST_F(Scenes, RootsOfAFewPixelsAreDrawnBitForBit) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 61, .height = 40, .frustum = false};
  options.double_sided = scene->has_double_sided;
  options.alpha_mask = scene->has_alpha_mask;
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer);
  const Box3d box = judge::world_box(*asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.high - box.low);
  std::uint64_t far_items = 0, covered = 0;
  for (int i = 0; i < 120; ++i) {
    run::Camera camera;
    camera.width = 61;
    camera.height = 40;
    const double turn = 2.399963229728653 * i, distance = size * (2.0 + 0.7 * (i % 40));
    camera.eye = center + distance * Vec3d(0.9 * std::cos(turn), 0.3 * std::sin(5.0 * turn), 0.9 * std::sin(turn));
    camera.target = center + 0.35 * distance * Vec3d(std::sin(3.0 * turn), std::cos(7.0 * turn), 0.2);
    camera.near_distance = 1e-3 * size;
    camera.is_orthographic = i % 5 == 0;
    camera.ortho_height = 0.7 * distance;
    const auto result = judge::compare_frame(*renderer, *asset, camera, i % 3 == 0 ? 0.25 : 30.0);
    ASSERT_TRUE(result) << result.error().message();
    EXPECT_EQ(result->cut.differences, 0U) << i << ": " << result->cut.first;
    EXPECT_EQ(result->pixels.differences, 0U) << i << ": " << result->pixels.first;
    far_items += result->frame.far_items;
    const auto pixels = renderer->read_pixels();
    ASSERT_TRUE(pixels);
    for (const std::uint32_t item : pixels->item) covered += item != VisibilityBuffer::kNothing ? 1 : 0;
  }
  EXPECT_GT(far_items, 100U);
  EXPECT_GT(covered, 1000U);
}

/// Hardware coverage follows its own rules: pixels may differ along edges alone, which are few.
TEST_F(Scenes, TheHardwareDrawsNearlyTheSamePicture) {
  const auto asset = run::Asset::from_vector(meshlode::test::sample_asset_bytes());
  ASSERT_TRUE(asset);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene);
  RendererOptions options{.width = 320, .height = 240, .frustum = false, .double_sided = true, .alpha_mask = true};
  options.hardware = HardwarePath::kVertex;
  options.hardware_pixels = 0.0F;
  auto renderer = Renderer::make(*device_, *scene, options);
  ASSERT_TRUE(renderer) << renderer.error().message();
  const run::Camera camera = judge::adversarial_cameras(*asset, 320, 240)[0].camera;
  const auto frame = renderer->draw(camera, 1.0, 0.0);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->hardware_items, frame->items);
  const auto hardware = renderer->read_pixels();
  ASSERT_TRUE(hardware);
  const auto software = draw_cut(*asset, run::select_flat(*asset, camera, 1.0), camera, *scene->alpha_masks);
  ASSERT_TRUE(software);
  std::size_t covered = 0, differ = 0, far = 0;
  for (std::size_t i = 0; i < software->pixel_count(); ++i) {
    const bool a = software->item[i] != VisibilityBuffer::kNothing, b = hardware->item[i] != VisibilityBuffer::kNothing;
    covered += a ? 1 : 0;
    differ += a != b ? 1 : 0;
    if (!a || !b) continue;
    const double ratio = software->depth[i] / std::max(1.0, hardware->depth[i] * 1.0);
    far += ratio < 0.98 || ratio > 1.02 ? 1 : 0;
  }
  EXPECT_GT(covered, 1000U);
  EXPECT_LE(differ, covered / 100);
  EXPECT_LE(far, covered / 100);
}

TEST(CameraPath, ReadsALineAFrame) {
  const auto path = judge::parse_camera_path("# a path\n0 0 5 0 0 0\n\n1,2,3, 0 0 0 40 0.5\r\n", {});
  ASSERT_TRUE(path) << path.error().message();
  ASSERT_EQ(path->size(), 2U);
  EXPECT_EQ((*path)[1].camera.eye, Vec3d(1.0, 2.0, 3.0));
  EXPECT_EQ((*path)[1].camera.near_distance, 0.5);
  for (const char* bad :
       {"", "1 2 3", "1 2 3 4 5 x", "0 0 0 0 0 0", "1 2 3 4 5 6 200", "1 2 3 4 5 6 40 -1", "nan 0 0 1 1 1"}) {
    EXPECT_FALSE(judge::parse_camera_path(bad, {})) << bad;
  }
}

TEST(Plan, AsksForWhatTheSceneCallsFor) {
  GpuScene scene;
  scene.instance_count = 1;
  scene.cluster_instances = 5000;
  auto plan = plan_passes(scene, {}, 64, 64);
  ASSERT_TRUE(plan);
  EXPECT_FALSE(plan->options.occlusion);
  EXPECT_FALSE(plan->options.double_sided);
  scene.instance_count = 5000;
  scene.cluster_instances = 5000000;
  scene.has_double_sided = true;
  plan = plan_passes(scene, {}, 64, 64);
  ASSERT_TRUE(plan);
  EXPECT_TRUE(plan->options.occlusion);
  EXPECT_TRUE(plan->options.double_sided);
  EXPECT_EQ(plan->options.hardware, HardwarePath::kNone);
  plan = plan_passes(scene, {}, 64, 64, {"all"});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->options.hardware, HardwarePath::kVertex);
  EXPECT_FALSE(plan_passes(scene, {}, 64, 64, {"magic"}));
  for (const PassDecision& decision : plan->decisions) EXPECT_FALSE(decision.reason.empty()) << decision.pass;
}

}  // namespace
}  // namespace meshlode::draw::test
