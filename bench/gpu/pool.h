// SPDX-License-Identifier: GPL-3.0-or-later
// A frame drawn from a pool of pages against the same frame with all pages resident.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "draw/gpu/vulkan/vulkan.h"
#include "run/read/asset.h"
#include "scenes.h"

namespace meshlode::bench {

struct PoolOptions {
  double share = 0.25;  ///< of the pages: draw::pool_slots()
  std::uint32_t width = 2240, height = 1260, frames = 200;
  double pixel_error = 1.0;
};

/// Medians of a pass by the device's clock, milliseconds; 0 where a renderer does not have it.
struct PassTimes {
  std::string pass;
  double all_ms = 0.0, pool_ms = 0.0;
};

struct PoolReport {
  std::uint32_t pages = 0, slots = 0;
  double all_ms = 0.0, pool_ms = 0.0;                 ///< medians of the frames' passes, by the device's clock
  std::vector<PassTimes> passes;                      ///< in the order of a frame; those of the pool alone are the last
  std::uint64_t all_clusters = 0, pool_clusters = 0;  ///< of all frames together
  std::uint64_t loads = 0;
  std::uint32_t incomplete = 0;  ///< frames that lacked a page
};

/// Draws a way around the scene and close to it, each frame by both renderers one after the other, so that a device
/// that slows down does so for both. Uploads lie between frames and are not timed.
[[nodiscard]] Result<PoolReport> measure_pool(draw::Device device, const run::Asset& asset, const BenchScene& scene,
                                              const PoolOptions& options);

}  // namespace meshlode::bench
