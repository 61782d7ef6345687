// SPDX-License-Identifier: GPL-3.0-or-later
// What verify --gpu adds to verify.
#pragma once

#include <cstdint>
#include <string>

#include <meshlode/result.h>

#include "judge/verify/verify.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::cli {

struct GpuOptions {
  bool is_on = false;
  bool is_explained = false;
  std::string device, path, out_folder, promise = "position";
  std::uint32_t orbits = 6;
  std::uint32_t frames = 600;
  double pixel_error = 1.0;
  std::uint64_t max_decoded = 0;  ///< bytes of decoded images
};

/// What the GPU finds, as checks and findings of the same report; heat maps and gpu.json where a folder is given.
/// Errors: as of with_promise() and judge::verify_on_gpu().
[[nodiscard]] Status verify_with_gpu(const run::Asset& asset, const scene::Scene& source, const GpuOptions& options,
                                     judge::VerifyReport& report);

/// The same of streaming: frames drawn from a pool of pages. Errors: as of judge::verify_streaming_on_gpu().
[[nodiscard]] Status verify_streaming_with_gpu(const run::Asset& asset, const GpuOptions& options,
                                               judge::VerifyReport& report);

}  // namespace meshlode::cli
