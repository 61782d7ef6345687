// SPDX-License-Identifier: GPL-3.0-or-later
// A build with MESHLODE_VULKAN off: there is no device, and whoever asks for one is told why.
#include "draw/gpu/render.h"
#include "draw/gpu/vulkan/vulkan.h"

namespace meshlode::draw {

namespace {

Error no_vulkan() {
  return {ErrorCode::kUnsupported, "--gpu", "this program was built without Vulkan"};
}

}  // namespace

Result<std::vector<DeviceInfo>> list_devices() {
  return no_vulkan();
}

Result<Device> Device::open(const DeviceOptions&) {
  return no_vulkan();
}

Status render_on_gpu(const run::Asset&, const run::Camera&, const GpuRenderOptions&, ImageBudget&, GpuPicture&) {
  return no_vulkan();
}

}  // namespace meshlode::draw
