// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshlode/camera_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "run/decode/decode.h"
#include "support/sample_asset.h"

namespace meshlode::cli {
namespace {

const run::Asset& sample() {
  static const run::Asset asset = *run::Asset::from_vector(test::sample_asset_bytes());
  return asset;
}

Result<run::Camera> camera_of(const std::string& text) {
  CameraOptions options;
  options.camera = text;
  return make_camera(options, sample());
}

TEST(CameraOptions, ReadsEyeTargetFieldOfViewAndNear) {
  const auto six = camera_of("1,-2.5,3e2,0,.5,-0");
  ASSERT_TRUE(six);
  EXPECT_EQ(six->eye, Vec3d(1.0, -2.5, 300.0));
  EXPECT_EQ(six->target, Vec3d(0.0, 0.5, 0.0));
  EXPECT_FALSE(six->is_orthographic);
  const auto eight = camera_of("0,0,5,0,0,0,90,0.25");
  ASSERT_TRUE(eight);
  EXPECT_DOUBLE_EQ(eight->fovy, std::numbers::pi / 2.0);
  EXPECT_EQ(eight->near_distance, 0.25);
}

TEST(CameraOptions, RefusesWhatIsNoCamera) {
  for (const char* text : {"", "1,2,3", "1,2,3,4,5,6,7,8,9", "1,2,3,4,5,x", "1,2,3,4,5,6,", ",1,2,3,4,5",
                           "nan,0,0,1,1,1", "inf,0,0,1,1,1", "1,1,1,1,1,1", "0,0,1,0,0,0,0", "0,0,1,0,0,0,180",
                           "0,0,1,0,0,0,45,0", "0,0,1,0,0,0,45,-1", "1 2 3 4 5 6", "1e999,0,0,1,1,1"}) {
    const auto camera = camera_of(text);
    ASSERT_FALSE(camera) << text;
    EXPECT_EQ(camera.error().code, ErrorCode::kUsage) << text;
  }
}

TEST(CameraOptions, ReadsSizeOrthoAndPixelError) {
  CameraOptions options;
  options.size = "640x31";
  options.ortho_height = 2.5;
  const auto camera = make_camera(options, sample());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 640U);
  EXPECT_EQ(camera->height, 31U);
  EXPECT_TRUE(camera->is_orthographic);
  EXPECT_EQ(camera->ortho_height, 2.5);
  for (const char* size :
       {"", "640", "x", "0x10", "10x0", "640X480", "640x480x1", "-1x5", "16385x1", "99999999999x1"}) {
    options.size = size;
    EXPECT_FALSE(make_camera(options, sample())) << size;
  }
  options.size = "8x8";
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    options.ortho_height = bad;
    EXPECT_FALSE(make_camera(options, sample())) << bad;
  }
  options.ortho_height.reset();
  for (const double bad : {-1.0, std::nan("")}) {
    options.pixel_error = bad;
    EXPECT_FALSE(make_camera(options, sample())) << bad;
  }
}

// Every vertex of every instance that can be drawn lies inside the picture, in front of the near plane; and the picture
// is not mostly empty: some vertex comes near its edge.
TEST(CameraOptions, TheDefaultFramesTheScene) {
  const auto clusters = run::decode_all(sample());
  ASSERT_TRUE(clusters);
  for (const auto& [width, height] : {std::pair{1280U, 720U}, std::pair{100U, 1000U}, std::pair{64U, 64U}}) {
    const run::Camera camera = frame_scene(sample(), width, height);
    const Vec3d forward = glm::normalize(camera.target - camera.eye);
    const Vec3d right = glm::normalize(glm::cross(forward, Vec3d(0.0, 1.0, 0.0)));
    const Vec3d up = glm::cross(right, forward);
    const double tangent = std::tan(0.5 * camera.fovy);
    const double aspect = static_cast<double>(width) / height;
    double farthest = 0.0;  // from the middle of the picture to its edge: 0 … 1
    for (const format::InstanceRecord& instance : sample().instances()) {
      const format::MeshRecord& mesh = sample().meshes()[instance.mesh];
      if ((instance.flags & format::kInstanceSingular) != 0) continue;
      const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
      for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
        if (sample().clusters()[c].level != 0) continue;
        const run::DecodedCluster& cluster = (*clusters)[c];
        for (std::uint32_t v = 0; v < cluster.vertex_count; ++v) {
          const Vec3d p = Vec3d(cluster.position(v)) * step + Vec3d(mesh.origin[0], mesh.origin[1], mesh.origin[2]);
          Vec3d world{0.0};
          for (int row = 0; row < 3; ++row) {
            const double* m = instance.transform + 4 * row;
            world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
          }
          const Vec3d d = world - camera.eye;
          const double depth = glm::dot(d, forward);
          EXPECT_GT(depth, camera.near_distance);
          farthest = std::max({farthest, std::abs(glm::dot(d, up)) / (depth * tangent),
                               std::abs(glm::dot(d, right)) / (depth * tangent * aspect)});
        }
      }
    }
    EXPECT_LE(farthest, 1.0);
    EXPECT_GE(farthest, 0.5);
  }
}

}  // namespace
}  // namespace meshlode::cli
