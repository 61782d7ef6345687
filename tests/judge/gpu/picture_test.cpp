// SPDX-License-Identifier: GPL-3.0-or-later
// The judge of pictures, which needs no device: it must see what it is there for.
#include <gtest/gtest.h>

#include "draw/gpu/gpu_support.h"
#include "judge/gpu/judge_picture.h"
#include "judge/metrics/metrics.h"
#include "judge/painted_ball.h"

namespace meshlode::judge::test {
namespace {

using meshlode::test::build_promised;
using meshlode::test::Built;
using meshlode::test::painted_scene;

struct Drawn {
  std::vector<std::uint8_t> bytes;
  std::optional<run::Asset> asset;
  std::vector<run::DecodedCluster> decoded;
  std::vector<SourceSurface> source;
  std::vector<run::ClusterInstance> cut;
  draw::VisibilityBuffer picture;
  run::Camera camera;
};

/// The rock's level 0, judged against itself.
Drawn draw_rock() {
  Drawn out;
  static const std::vector<std::uint8_t> built = draw::test::build_file(MESHLODE_DATA "/rock.glb");
  out.bytes = built;
  auto asset = run::Asset::from_vector(out.bytes);
  EXPECT_TRUE(asset);
  out.asset = std::move(*asset);
  out.camera = adversarial_cameras(*out.asset, 160, 120)[0].camera;
  out.cut = run::select_flat(*out.asset, out.camera, 0.0);
  auto decoded = run::decode_all(*out.asset);
  EXPECT_TRUE(decoded);
  out.decoded = std::move(*decoded);
  std::vector<ClusterId> clusters;
  for (const run::ClusterInstance& entry : out.cut) clusters.push_back(entry.cluster);
  out.source.emplace_back(surface_of_clusters(*out.asset, out.decoded, MeshId(std::uint32_t{0}), clusters));
  auto picture = draw::draw_cut(*out.asset, out.cut, out.camera);
  EXPECT_TRUE(picture);
  out.picture = std::move(*picture);
  return out;
}

TEST(Picture, TheSourceItselfHasNoFault) {
  const Drawn rock = draw_rock();
  const auto report =
      judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, rock.cut, rock.picture, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_GT(report->covered, 1000U);
  EXPECT_EQ(report->covered, report->covered_source);
  EXPECT_EQ(report->holes + report->exceeded + report->only_cut + report->only_source, 0U);
  EXPECT_LT(report->largest_px, 1e-6);
  EXPECT_GT(report->normals, 1000U);
  EXPECT_LT(report->largest_normal_degrees, 1e-4);
}

TEST(Picture, ErasedPixelsAreHoles) {
  Drawn rock = draw_rock();
  std::size_t erased = 0;
  for (std::uint32_t y = 58; y < 61; ++y) {
    const std::size_t at = std::size_t{y} * 160 + 80;  // in the middle of the rock
    erased += rock.picture.item[at] != draw::VisibilityBuffer::kNothing ? 1 : 0;
    rock.picture.item[at] = draw::VisibilityBuffer::kNothing;
    rock.picture.depth[at] = 0;
  }
  ASSERT_EQ(erased, 3U);
  const auto report =
      judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, rock.cut, rock.picture, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->holes, 3U);
}

/// A cluster that is missing lets the eye in: the far side is seen from behind.
TEST(Picture, AMissingClusterIsAHole) {
  Drawn rock = draw_rock();
  std::vector<run::ClusterInstance> cut;
  const std::uint32_t missing = rock.picture.item[60 * 160 + 80];
  ASSERT_LT(missing, rock.cut.size());
  for (std::size_t i = 0; i < rock.cut.size(); ++i) {
    if (i != missing) cut.push_back(rock.cut[i]);
  }
  const auto picture = draw::draw_cut(*rock.asset, cut, rock.camera);
  ASSERT_TRUE(picture);
  const auto report = judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, cut, *picture, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_GT(report->holes, 10U);
}

/// The same surface with its picture elsewhere: told where texels are promised, pixel by pixel and both ways, and as
/// far as the picture swam.
TEST(Picture, ATextureThatSwamExceedsThePromiseOfTexels) {
  const Built ball = build_promised(painted_scene(), format::Promise::kTexels);
  const auto opened = run::Asset::from_vector(ball.bytes);
  ASSERT_TRUE(opened);
  const auto asset = opened->with_promise(format::Promise::kTexels);
  ASSERT_TRUE(asset);
  run::Camera camera = adversarial_cameras(*asset, 160, 120)[0].camera;
  camera.is_orthographic = true;
  camera.ortho_height = 3.0;
  const auto decoded = run::decode_all(*asset);
  ASSERT_TRUE(decoded);
  const std::vector<run::ClusterInstance> cut = run::select_flat(*asset, camera, 0.0);
  const auto drawn = draw::draw_cut(*asset, cut, camera);
  ASSERT_TRUE(drawn);
  constexpr float kSwum = 0.05F;
  const double units = scales_of(*asset, MeshId(std::uint32_t{0}), format::Promise::kTexels).uv[0].y;
  for (const float swum : {0.0F, kSwum}) {
    scene::Scene scene = ball.scene;
    for (Vec2f& uv : scene.meshes[0].primitives[0].uvs[0]) uv.y += swum;
    const std::vector<SourceSurface> source = source_surfaces(scene);
    const std::vector<PaintedSurface> painted = painted_surfaces(*asset, scene);
    const auto report = judge_picture(*asset, {source, *decoded, 1.0, painted}, cut, *drawn, camera, 1.0);
    ASSERT_TRUE(report);
    EXPECT_GT(report->covered, 3000U);
    EXPECT_EQ(report->exceeded > report->points / 2, swum > 0.0F);
    EXPECT_EQ(report->exceeded > 0, swum > 0.0F);
    const double px = static_cast<double>(swum) * units * 120.0 / 3.0;
    EXPECT_LE(report->largest_px, px + 0.2) << "no point is farther than its own place";
    EXPECT_GE(report->largest_px, 0.5 * px);
    const auto by_position = judge_picture(*asset, {source, *decoded, 1.0}, cut, *drawn, camera, 1.0);
    ASSERT_TRUE(by_position);
    EXPECT_EQ(by_position->exceeded, 0U);
  }
}

/// Level 0 may have lost what the source has: the cut is level 0 itself, bit for bit, and yet it is told.
TEST(Picture, ATriangleThatLevel0LostIsSeenInTheSourcesPicture) {
  Drawn rock = draw_rock();
  Surface surface = rock.source[0].surface;
  const Box3d box = world_box(*rock.asset);
  const Vec3d size = box.high - box.low;
  const auto first = static_cast<std::uint32_t>(surface.positions.size());
  for (const Vec3d& corner : {Vec3d(0.0, 0.0, 0.0), Vec3d(0.3, 0.0, 0.0), Vec3d(0.0, 0.3, 0.0)}) {
    surface.positions.push_back(box.high + corner * size);  // beside the rock, in the picture
  }
  surface.triangles.push_back({first, first + 1, first + 2});
  rock.source.clear();
  rock.source.emplace_back(surface).double_sided.assign(surface.triangles.size(), 1);
  const auto report =
      judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, rock.cut, rock.picture, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_GT(report->exceeded, 10U);
  EXPECT_GT(report->covered_source, report->covered);
  EXPECT_EQ(report->only_source, 0U) << "by level 0 nothing is missing";
}

/// An instance of which nothing is drawn is no nearer to its source than infinity.
TEST(Picture, AnInstanceThatIsMissingExceedsThePromise) {
  const Drawn rock = draw_rock();
  const draw::VisibilityBuffer nothing = draw::make_visibility_buffer(160, 120);
  const auto report = judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, {}, nothing, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->exceeded, report->covered_source);
  EXPECT_GT(report->covered_source, 1000U);
}

/// The near plane opens a surface that has moved through it by less than the promise; elsewhere the same is a hole.
TEST(Picture, WhatMayHaveMovedThroughTheNearPlaneIsNoHole) {
  Drawn rock = draw_rock();
  std::uint64_t holes[2] = {0, 0};
  for (const bool is_near : {false, true}) {
    const std::size_t at = std::size_t{60} * 160 + 80;
    draw::VisibilityBuffer picture = rock.picture;
    if (is_near) {  // a near plane just before the surface in the middle of the picture
      const double share = picture.depth[at] / 4294967296.0;
      rock.camera.near_distance = rock.camera.near_distance / share * (1.0 - 1e-5);
      auto drawn = draw::draw_cut(*rock.asset, rock.cut, rock.camera);
      ASSERT_TRUE(drawn);
      picture = std::move(*drawn);
      ASSERT_NE(picture.item[at], draw::VisibilityBuffer::kNothing);
    }
    picture.item[at] = draw::VisibilityBuffer::kNothing;
    picture.depth[at] = 0;
    const auto report =
        judge_picture(*rock.asset, {rock.source, rock.decoded, 1.0}, rock.cut, picture, rock.camera, 1.0);
    ASSERT_TRUE(report);
    holes[is_near ? 1 : 0] = report->holes;
  }
  EXPECT_EQ(holes[0], 1U);
  EXPECT_EQ(holes[1], 0U);
}

TEST(Picture, ACutThatIsTooCoarseExceedsThePromise) {
  Drawn rock = draw_rock();
  rock.cut = run::select_flat(*rock.asset, rock.camera, 20.0);
  auto picture = draw::draw_cut(*rock.asset, rock.cut, rock.camera);
  ASSERT_TRUE(picture);
  const auto report =
      judge_picture(*rock.asset, {rock.source, rock.decoded, 1.05}, rock.cut, *picture, rock.camera, 1.0);
  ASSERT_TRUE(report);
  EXPECT_GT(report->largest_px, 1.05);
  EXPECT_GT(report->exceeded, 0U);
  EXPECT_GT(report->mean_normal_degrees, 0.1);
}

TEST(Picture, AHeatMapGoesFromBlueToRed) {
  const std::vector<float> values = {-1.0F, 0.0F, 1.0F, 7.0F};
  const draw::Image image = heat_map(values, 4, 1, 1.0F);
  ASSERT_EQ(image.rgba.size(), 16U);
  EXPECT_EQ(image.rgba[0], image.rgba[1]) << "grey: nothing there";
  EXPECT_GT(image.rgba[4 + 2], image.rgba[4 + 0]) << "blue at 0";
  EXPECT_GT(image.rgba[8 + 0], image.rgba[8 + 2]) << "red at full";
  EXPECT_TRUE(std::equal(&image.rgba[8], &image.rgba[12], &image.rgba[12])) << "and above";
}

}  // namespace
}  // namespace meshlode::judge::test
