// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu_support.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "import/import.h"
#include "pipeline/build.h"

namespace meshlode::gpu::test {

std::optional<Device> shared_device(std::string& why) {
  static const Result<Device> device = [] {
    constexpr const char* kLavapipe = "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json";
    if (std::filesystem::exists(kLavapipe)) setenv("VK_DRIVER_FILES", kLavapipe, 0);
    return Device::open({.device = "", .validate = true});
  }();
  if (device) return *device;
  why = device.error().message();
  return std::nullopt;
}

void GpuTest::SetUp() {
  std::string why;
  device_ = shared_device(why);
  if (device_) return;
  const char* required = std::getenv("MESHLODE_REQUIRE_GPU");
  ASSERT_FALSE(required != nullptr && std::string(required) == "1") << why;
  GTEST_SKIP() << why;
}

void GpuTest::TearDown() {
  if (!device_) return;
  for (const std::string& message : device_->messages()) ADD_FAILURE() << message;
}

Box world_box(const Asset& asset) {
  Box box;
  bool is_first = true;
  for (const format::InstanceRecord& instance : asset.instances()) {
    const format::MeshRecord& mesh = asset.meshes()[instance.mesh];
    if ((instance.flags & format::kInstanceSingular) != 0 || mesh.cluster_count == 0) continue;
    const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
    for (int corner = 0; corner < 8; ++corner) {
      Vec3d p{0.0}, world{0.0};
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] =
            mesh.origin[axis] + step * ((corner >> axis & 1) != 0 ? mesh.bounds_max[axis] : mesh.bounds_min[axis]);
      }
      for (int row = 0; row < 3; ++row) {
        const double* m = instance.transform + 4 * row;
        world[row] = m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
      }
      for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = is_first ? world[axis] : std::min(box.low[axis], world[axis]);
        box.high[axis] = is_first ? world[axis] : std::max(box.high[axis], world[axis]);
      }
      is_first = false;
    }
  }
  return box;
}

std::vector<NamedCamera> adversarial_cameras(const Asset& asset, std::uint32_t width, std::uint32_t height) {
  const Box box = world_box(asset);
  const Vec3d center = 0.5 * (box.low + box.high);
  const double size = glm::length(box.high - box.low);
  const auto make = [&](const char* name, const Vec3d& eye, const Vec3d& target) {
    NamedCamera out{name, {}};
    out.camera.eye = eye;
    out.camera.target = target;
    out.camera.width = width;
    out.camera.height = height;
    out.camera.near_distance = 1e-3 * size;
    return out;
  };
  std::vector<NamedCamera> out;
  out.push_back(make("orbit", center + size * Vec3d(0.5, 0.4, 0.9), center));
  out.push_back(make("behind", center + size * Vec3d(-0.6, 0.1, -0.7), center));
  out.push_back(make("inside", center + size * Vec3d(0.02, 0.01, 0.03), center + size * Vec3d(1.0, 0.2, 0.4)));
  out.push_back(
      make("grazing", Vec3d(center.x, box.high.y - 0.05 * size, center.z), center + size * Vec3d(0.7, 0.0, 0.2)));
  out.push_back(make("far", center + 60.0 * size * Vec3d(0.5, 0.4, 0.9), center));
  out.push_back(make("near plane", center + size * Vec3d(0.3, 0.2, 0.3), center));
  out.back().camera.near_distance = 0.42 * size;
  out.push_back(make("keyhole", center + 20.0 * size * Vec3d(0.3, 0.5, 0.8), center));
  out.back().camera.fovy = 0.02;
  out.push_back(make("wide", center + 0.4 * size * Vec3d(-0.4, 0.5, 0.8), center));
  out.back().camera.fovy = 2.8;
  out.push_back(make("down", center + size * Vec3d(0.0, 1.1, 0.0), center));
  out.push_back(make("orthographic", center + size * Vec3d(0.5, 0.4, 0.9), center));
  out.back().camera.is_orthographic = true;
  out.back().camera.ortho_height = 0.6 * size;
  return out;
}

std::vector<std::uint8_t> build_file(const std::string& path) {
  auto scene = import_scene(path, {});
  if (!scene) {
    ADD_FAILURE() << scene.error().message();
    return {};
  }
  PipelineReport report;
  auto bytes = build_lode(*scene, {}, {}, report);
  if (bytes) return std::move(*bytes);
  ADD_FAILURE() << bytes.error().message();
  return {};
}

}  // namespace meshlode::gpu::test
