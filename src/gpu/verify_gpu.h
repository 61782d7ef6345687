// SPDX-License-Identifier: GPL-3.0-or-later
// All that `verify --gpu` checks on one asset.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "base/output_files.h"
#include "gpu/cameras.h"
#include "gpu/vulkan.h"
#include "gpu/picture.h"
#include "metrics/metrics.h"

namespace meshlode::gpu {

struct GpuVerifyOptions {
  DeviceOptions device;
  std::uint32_t orbits = 6;       ///< cameras around the scene, beside the adversarial ones
  std::vector<NamedCamera> path;  ///< a fly-through, judged as the orbits are
  double pixel_error = 1.0;
  /// Heat maps (PNG) of the camera with the largest displacement at each size, and of each that failed; empty: none.
  std::string out_folder;
  OutputFiles* files = nullptr;  ///< what they are written by; null: by an object of their own
};

/// One picture against the source.
struct JudgedCamera {
  NamedCamera camera;
  PictureReport picture;  ///< without its maps
  std::vector<std::string> maps;  ///< files in out_folder
};

struct GpuCheck {
  std::string id, invariant, what;
  std::uint64_t items = 0, failures = 0;
  bool is_skipped = false;
  std::string first{};  ///< the first failure, in words
};

struct GpuVerifyReport {
  DeviceInfo device;
  std::vector<GpuCheck> checks;
  double largest_px = 0.0;
  std::vector<JudgedCamera> cameras;
  std::vector<std::string> warnings;  ///< images that could not be had
};

/// `source`: each mesh's source surface, mesh space. Errors: kUnsupported without a device, kInvalid for a broken page.
[[nodiscard]] Result<GpuVerifyReport> verify_on_gpu(const Asset& asset, std::span<const Surface> source,
                                                    const GpuVerifyOptions& options);

}  // namespace meshlode::gpu
