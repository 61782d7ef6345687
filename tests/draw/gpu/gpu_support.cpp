// SPDX-License-Identifier: GPL-3.0-or-later
#include "gpu_support.h"

#include <cstdlib>
#include <filesystem>

#include "builder/builder.h"
#include "scene/import/import.h"

namespace meshlode::draw::test {

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

std::vector<std::uint8_t> build_file(const std::string& path, const builder::PipelineOptions& options) {
  auto scene = scene::import_scene(path, {});
  if (!scene) {
    ADD_FAILURE() << scene.error().message();
    return {};
  }
  builder::PipelineReport report;
  auto bytes = builder::build_lode(*scene, options, {}, report);
  if (bytes) return std::move(*bytes);
  ADD_FAILURE() << bytes.error().message();
  return {};
}

}  // namespace meshlode::draw::test
