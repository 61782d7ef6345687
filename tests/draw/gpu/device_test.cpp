// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <gtest/gtest.h>

#include "draw/gpu/passes/pass.h"
#include "draw/gpu/shaders.h"
#include "gpu_support.h"

namespace meshlode::draw::test {
namespace {

using Gpu = GpuTest;

TEST_F(Gpu, BytesComeBackAsTheyWent) {
  const auto buffer = device_->make_buffer(1000, Memory::kDevice);
  ASSERT_TRUE(buffer) << buffer.error().message();
  std::vector<std::uint8_t> bytes(997), back(997);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 7);
  ASSERT_TRUE(device_->upload(*buffer, bytes, 3));
  ASSERT_TRUE(device_->download(*buffer, back, 3));
  EXPECT_EQ(bytes, back);
  EXPECT_FALSE(device_->upload(*buffer, bytes, 12)) << "past the end";
}

TEST_F(Gpu, ANameThatNoDeviceHasIsAUsageError) {
  const auto device = Device::open({.device = "no such device", .validate = false});
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error().code, ErrorCode::kUsage);
  EXPECT_NE(device.error().message().find(device_->info().name), std::string::npos) << "it lists what there is";
}

TEST_F(Gpu, TheFirstDeviceIsTheFirstOfTheList) {
  const auto devices = list_devices();
  ASSERT_TRUE(devices);
  ASSERT_FALSE(devices->empty());
  const auto device = Device::open({.device = "0", .validate = false});
  ASSERT_TRUE(device) << device.error().message();
  EXPECT_EQ(device->info().name, devices->front().name);
}

TEST(Shaders, AreThereByEveryNameThatIsAskedFor) {
  const auto expect_is_there = [](std::string_view name) {
    const auto all = all_shaders();
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Shader& s) { return s.name == name; })) << name;
  };
  for (const Pass* pass : {&kInstancesPass, &kTraversePass, &kPersistentPass, &kClustersPass, &kSoftwarePass, &kFarPass,
                           &kClippedPass, &kHardwarePass, &kPyramidPass}) {
    if (pass->shader != nullptr) expect_is_there(pass->shader);
    if (pass->masked != nullptr) expect_is_there(pass->masked);
  }
  for (const char* name :
       {"hardware.mesh", "hardware.vert", "hardware.frag", "hardware_mesh.frag", "hardware_mask.frag",
        "hardware_mesh_mask.frag", "resolve.comp", "resolve_textures.comp", "sort.comp", "roots.comp", "decode.comp"})
    expect_is_there(name);
}

}  // namespace
}  // namespace meshlode::draw::test
