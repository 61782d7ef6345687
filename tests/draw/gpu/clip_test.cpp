// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles across the near plane, where the covered pixels can be told in closed form.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "gpu_support.h"
#include "judge/gpu/compare_frame.h"
#include "support/parallel_camera.h"

namespace meshlode::draw::test {
namespace {

using Clip = GpuTest;

/// Looks along -z, eight units high; its near plane is z = 2.
run::Camera cutting_camera(std::uint32_t width, std::uint32_t height) {
  run::Camera camera = meshlode::test::parallel_camera({0.0, 0.0, 0.0}, 10.0, 8.0, width, height);
  camera.near_distance = 8.0;
  return camera;
}

/// A rectangle on the plane z = 4 y, seen along -z at 8 pixels a unit: its left, right and lower edges run exactly
/// through pixel centres, and the near plane cuts both its triangles at y = 1/2, between two rows of centres. By the
/// top-left rule the left edge's centres are in and those of the right and the lower one are out.
/// (Guards: 64-bit comparisons of widened differences, which one driver gets wrong, gave the left edge's centres away.)
TEST_F(Clip, AnEdgeThroughPixelCentresFollowsTheTopLeftRule) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "meshlode_clip_rectangle.obj";
  std::ofstream(path) << "v -1.9375 -1.9375 -7.75\nv 2.0625 -1.9375 -7.75\nv 2.0625 2 8\nv -1.9375 2 8\nf 1 2 3 4\n";
  const std::vector<std::uint8_t> bytes = build_file(path.string());
  std::filesystem::remove(path);
  ASSERT_FALSE(bytes.empty());
  const auto asset = run::Asset::from_vector(bytes);
  ASSERT_TRUE(asset) << asset.error().message();
  const run::Camera camera = cutting_camera(64, 64);

  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene) << scene.error().message();
  auto renderer = Renderer::make(*device_, *scene, {.width = 64, .height = 64});
  ASSERT_TRUE(renderer) << renderer.error().message();
  const auto result = judge::compare_frame(*renderer, *asset, camera, 1.0);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_EQ(result->pixels.differences, 0U) << result->pixels.first;
  EXPECT_EQ(result->frame.clipped_items, 1U);
  const auto pixels = renderer->read_pixels();
  ASSERT_TRUE(pixels);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) {
      const bool is_inside = x >= 16 && x < 48 && y >= 28 && y < 47;
      EXPECT_EQ(pixels->item[y * 64 + x] != VisibilityBuffer::kNothing, is_inside) << x << "," << y;
    }
  }
}

/// Twenty triangles of one cluster, each cut by the near plane and as large as the picture.
/// (Guards: one driver ends an invocation after 65,535 iterations of all its loops, and each pixel had seven.)
TEST_F(Clip, ManyClippedTrianglesOfAClusterThatCoverThePictureAreDrawnToTheEnd) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "meshlode_clip_walls.obj";
  {
    std::ofstream out(path);
    for (int i = 0; i < 10; ++i) {  // on the planes z = y / 10 + 1 - i / 10
      const double low = -1.0 - 0.1 * i, high = 3.0 - 0.1 * i;
      out << "v -20 -20 " << low << "\nv 20 -20 " << low << "\nv 20 20 " << high << "\nv -20 20 " << high << "\n";
      out << "f " << 4 * i + 1 << " " << 4 * i + 2 << " " << 4 * i + 3 << " " << 4 * i + 4 << "\n";
    }
  }
  const auto asset = run::Asset::from_vector(build_file(path.string()));
  std::filesystem::remove(path);
  ASSERT_TRUE(asset) << asset.error().message();
  const run::Camera camera = cutting_camera(640, 360);
  const auto scene = upload_scene(*device_, *asset);
  ASSERT_TRUE(scene) << scene.error().message();
  auto renderer = Renderer::make(*device_, *scene, {.width = 640, .height = 360, .frustum = false});
  ASSERT_TRUE(renderer) << renderer.error().message();
  const auto result = judge::compare_frame(*renderer, *asset, camera, 1e-9);
  ASSERT_TRUE(result) << result.error().message();
  EXPECT_EQ(result->frame.clipped_items, 1U);
  EXPECT_EQ(result->pixels.differences, 0U) << result->pixels.first;
  const auto pixels = renderer->read_pixels();
  ASSERT_TRUE(pixels);
  EXPECT_EQ(std::count(pixels->item.begin(), pixels->item.end(), VisibilityBuffer::kNothing), 0);
}

}  // namespace
}  // namespace meshlode::draw::test
