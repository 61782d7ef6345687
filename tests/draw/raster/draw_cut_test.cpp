// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts of whole assets: the picture agrees with a ray caster that shares no code, and does not depend on threads.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "draw/raster/raster.h"
#include "run/decode/decode.h"
#include "support/sample_asset.h"

namespace meshlode::draw {
namespace {

run::Asset open_asset(std::vector<std::uint8_t> bytes) {
  Result<run::Asset> asset = run::Asset::from_vector(std::move(bytes));
  EXPECT_TRUE(asset.ok()) << asset.error().message();
  return std::move(asset.value());
}

run::Camera ball_camera() {
  run::Camera camera;
  camera.eye = {1.0, 2.0, 20.0};
  camera.target = {2.0, 0.0, 7.0};
  camera.near_distance = 0.1;
  camera.width = 97;
  camera.height = 61;
  return camera;
}

struct Hit {
  double distance = std::numeric_limits<double>::infinity();  ///< along the view
  run::ClusterInstance entry;
  double margin = 0.0;  ///< smallest barycentric weight: how far from an edge
};

/// Moeller and Trumbore's ray against every triangle of the cut, culling as the rasterizer says it does.
std::vector<Hit> cast_rays(const run::Asset& asset, std::span<const run::ClusterInstance> cut,
                           const run::Camera& camera, double px, double py) {
  const Vec3d forward = glm::normalize(camera.target - camera.eye);
  const Vec3d right = glm::normalize(glm::cross(forward, Vec3d(0, 1, 0)));
  const Vec3d up = glm::cross(right, forward);
  Vec3d from = camera.eye, ray = forward;
  if (camera.is_orthographic) {
    const double unit = camera.ortho_height / camera.height;
    from += right * ((px - 0.5 * camera.width) * unit) - up * ((py - 0.5 * camera.height) * unit);
  } else {
    const double unit = 2.0 * std::tan(0.5 * camera.fovy) / camera.height;
    ray += right * ((px - 0.5 * camera.width) * unit) - up * ((py - 0.5 * camera.height) * unit);
  }
  const auto clusters = run::decode_all(asset);
  std::vector<Hit> hits;
  for (const run::ClusterInstance& entry : cut) {
    const format::InstanceRecord& instance = asset.instances()[entry.instance.value];
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    const run::DecodedCluster& cluster = (*clusters)[entry.cluster.value];
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    const auto world = [&](std::uint32_t v) {
      const Vec3d p = Vec3d(mesh.origin[0], mesh.origin[1], mesh.origin[2]) + step * Vec3d(cluster.position(v));
      const double* m = instance.transform;
      return Vec3d(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                   m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]);
    };
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t) {
      const auto [i, j, k] = cluster.triangles[t];
      const Vec3d a = world(i), b = world(j), c = world(k);
      const bool is_mirrored = (instance.flags & format::kInstanceMirrored) != 0;
      const double facing = glm::dot(glm::cross(b - a, c - a), ray) * (is_mirrored ? -1.0 : 1.0);
      if (asset.materials()[cluster.triangle_material[t]].double_sided == 0 && facing >= 0.0) continue;
      const Vec3d cross = glm::cross(ray, c - a);
      const double det = glm::dot(b - a, cross);
      if (det == 0.0) continue;
      const Vec3d rest = from - a;
      const double u = glm::dot(rest, cross) / det;
      const Vec3d other = glm::cross(rest, b - a);
      const double v = glm::dot(ray, other) / det;
      const double distance = glm::dot(c - a, other) / det * glm::dot(ray, forward);
      if (u < 0.0 || v < 0.0 || u + v > 1.0 || distance < camera.near_distance) continue;
      hits.push_back({distance, entry, std::min({u, v, 1.0 - u - v})});
    }
  }
  std::ranges::sort(hits, {}, &Hit::distance);
  return hits;
}

void expect_rays_agree(const run::Asset& asset, const run::Camera& camera, double pixel_error) {
  const std::vector<run::ClusterInstance> cut = run::select_flat(asset, camera, pixel_error);
  const Result<VisibilityBuffer> buffer = draw_cut(asset, cut, camera);
  ASSERT_TRUE(buffer.ok()) << buffer.error().message();
  std::size_t compared = 0, drawn = 0, agreed = 0;
  for (std::uint32_t y = 0; y < camera.height; y += 3) {
    for (std::uint32_t x = 0; x < camera.width; x += 3) {
      const std::vector<Hit> hits = cast_rays(asset, cut, camera, x + 0.5, y + 0.5);
      const std::uint32_t item = buffer->item[y * camera.width + x];
      ++compared;
      drawn += item != VisibilityBuffer::kNothing ? 1 : 0;
      if (hits.empty()) {
        agreed += item == VisibilityBuffer::kNothing ? 1 : 0;
        continue;
      }
      if (item == VisibilityBuffer::kNothing) continue;
      // On an edge either neighbour may be right: any triangle at the same distance counts.
      const bool is_same = std::ranges::any_of(hits, [&](const Hit& hit) {
        return hit.entry == cut[item] && hit.distance <= hits.front().distance * (1.0 + 1e-3);
      });
      agreed += is_same ? 1 : 0;
      if (!camera.is_orthographic && is_same) {
        const double distance = 4294967296.0 * camera.near_distance / buffer->depth[y * camera.width + x];
        EXPECT_NEAR(distance / hits.front().distance, 1.0, 2e-2);
      }
    }
  }
  EXPECT_GT(drawn, compared / 50);
  EXPECT_GE(static_cast<double>(agreed), 0.985 * static_cast<double>(compared));  // silhouettes within a subpixel
}

TEST(RasterCut, AgreesWithARayCaster) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  for (const double pixel_error : {0.0, 1.0, 1e6}) expect_rays_agree(asset, ball_camera(), pixel_error);
}

TEST(RasterCut, AgreesWithARayCasterThroughTheNearPlane) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  run::Camera camera = ball_camera();
  camera.eye = {0.1, 0.2, 7.1};  // close to the ball, or in it
  camera.target = {4.0, 0.0, 8.0};
  camera.fovy = 1.8;
  expect_rays_agree(asset, camera, 1.0);
}

TEST(RasterCut, AgreesWithARayCasterInParallelProjection) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  run::Camera camera = ball_camera();
  camera.is_orthographic = true;
  camera.ortho_height = 8.0;
  expect_rays_agree(asset, camera, 1.0);
}

TEST(RasterCut, IsTheSameForEveryNumberOfThreads) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  const run::Camera camera = ball_camera();
  const std::vector<run::ClusterInstance> cut = run::select_flat(asset, camera, 0.0);
  std::optional<VisibilityBuffer> first;
  std::vector<std::uint8_t> first_png;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Result<VisibilityBuffer> buffer = draw_cut(asset, cut, camera);
    const Result<Image> image = render_cut(asset, cut, camera, View::kShaded);
    ASSERT_TRUE(buffer.ok() && image.ok());
    if (!first) first = *buffer, first_png = encode_png(*image);
    EXPECT_TRUE(*first == *buffer);
    EXPECT_EQ(first_png, encode_png(*image));
  }
}

TEST(RasterCut, AMirroredBallShowsItsOutside) {
  // The ball's front and its mirror image's: if culling did not flip, the far inside would be seen, at larger distance.
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  run::Camera camera = ball_camera();
  camera.eye = {4.0, 0.0, 30.0};
  camera.target = {4.0, 0.0, 8.0};
  const std::vector<run::ClusterInstance> cut = run::select_flat(asset, camera, 0.0);
  std::vector<run::ClusterInstance> mirrored;
  for (const run::ClusterInstance& entry : cut) {
    if ((asset.instances()[entry.instance.value].flags & format::kInstanceMirrored) != 0) mirrored.push_back(entry);
  }
  ASSERT_FALSE(mirrored.empty());
  const Result<VisibilityBuffer> buffer = draw_cut(asset, mirrored, camera);
  ASSERT_TRUE(buffer.ok());
  const std::size_t middle = (camera.height / 2) * camera.width + camera.width / 2;
  ASSERT_NE(buffer->item[middle], VisibilityBuffer::kNothing);
  EXPECT_LT(4294967296.0 * camera.near_distance / buffer->depth[middle], 22.0);  // nearer than its centre
}

TEST(RasterCut, ASingularInstanceIsNotDrawn) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  std::vector<run::ClusterInstance> cut;
  for (std::size_t i = 0; i < asset.instances().size(); ++i) {
    const format::InstanceRecord& instance = asset.instances()[i];
    if ((instance.flags & format::kInstanceSingular) == 0) continue;
    cut.push_back({InstanceId(i), ClusterId(asset.meshes()[instance.mesh].first_cluster)});
  }
  ASSERT_FALSE(cut.empty());
  const Result<VisibilityBuffer> buffer = draw_cut(asset, cut, ball_camera());
  ASSERT_TRUE(buffer.ok());
  EXPECT_TRUE(std::ranges::all_of(buffer->item, [](std::uint32_t i) { return i == VisibilityBuffer::kNothing; }));
}

TEST(RasterCut, BadCamerasAreRefusedByName) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto refused = [&](auto change, const char* field) {
    run::Camera camera = ball_camera();
    change(camera);
    const Result<VisibilityBuffer> buffer = draw_cut(asset, {}, camera);
    ASSERT_FALSE(buffer.ok()) << field;
    EXPECT_EQ(buffer.error().code, ErrorCode::kUsage);
    EXPECT_NE(buffer.error().where.find(field), std::string::npos) << buffer.error().where;
  };
  refused([&](run::Camera& c) { c.eye.y = nan; }, "eye");
  refused([&](run::Camera& c) { c.target.x = inf; }, "target");
  refused([&](run::Camera& c) { c.target = c.eye; }, "target");
  refused([&](run::Camera& c) { c.fovy = nan; }, "fovy");
  refused([&](run::Camera& c) { c.fovy = 0.0; }, "fovy");
  refused([&](run::Camera& c) { c.fovy = 3.2; }, "fovy");
  refused([&](run::Camera& c) { c.near_distance = 0.0; }, "near");
  refused([&](run::Camera& c) { c.near_distance = nan; }, "near");
  refused([&](run::Camera& c) { c.is_orthographic = true, c.ortho_height = -1.0; }, "height");
  refused([&](run::Camera& c) { c.width = 0; }, "size");
  refused([&](run::Camera& c) { c.height = 20000; }, "size");
}

TEST(RasterCut, IdsThatTheAssetDoesNotHaveAreRefused) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  const run::ClusterInstance first{InstanceId(0u), ClusterId(asset.meshes()[asset.instances()[0].mesh].first_cluster)};
  EXPECT_TRUE(draw_cut(asset, std::vector{first}, ball_camera()).ok());
  for (const run::ClusterInstance bad :
       {run::ClusterInstance{InstanceId(99u), first.cluster}, run::ClusterInstance{first.instance, ClusterId(99999u)},
        run::ClusterInstance{InstanceId(1u), first.cluster}, run::ClusterInstance{}}) {
    EXPECT_FALSE(draw_cut(asset, std::vector{bad}, ball_camera()).ok());
  }
}

TEST(RasterCut, LooksStraightDownAndUp) {
  const run::Asset asset = open_asset(test::sample_asset_bytes());
  for (const double side : {1.0, -1.0}) {
    run::Camera camera = ball_camera();
    camera.eye = {0.0, 12.0 * side, 6.0};
    camera.target = {0.0, 0.0, 6.0};
    const Result<VisibilityBuffer> buffer = draw_cut(asset, run::select_flat(asset, camera, 0.0), camera);
    ASSERT_TRUE(buffer.ok());
    EXPECT_NE(buffer->item[30 * 97 + 48], VisibilityBuffer::kNothing);
  }
}

}  // namespace
}  // namespace meshlode::draw
