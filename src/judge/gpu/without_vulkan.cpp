// SPDX-License-Identifier: GPL-3.0-or-later
// A build with MESHLODE_VULKAN off: no device opens, and there is nothing to judge.
#include "judge/gpu/verify_gpu.h"

namespace meshlode::judge {

Result<GpuVerifyReport> verify_on_gpu(const run::Asset&, const scene::Scene&, const GpuVerifyOptions& options) {
  return draw::Device::open(options.device).error();
}

Result<StreamFramesReport> verify_streaming_on_gpu(const run::Asset&, const StreamFrameOptions& options) {
  return draw::Device::open(options.device).error();
}

}  // namespace meshlode::judge
