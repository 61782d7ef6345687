// SPDX-License-Identifier: GPL-3.0-or-later
// Which passes a scene calls for, and why: what `--explain` prints, and what `--force` overrides.
#pragma once

#include <string>
#include <vector>

#include "draw/gpu/gpu_scene.h"
#include "draw/gpu/renderer.h"

namespace meshlode::draw {

struct PassDecision {
  std::string pass, reason;
  bool runs = false;
};

struct PassPlan {
  RendererOptions options;
  std::vector<PassDecision> decisions;
  bool textures = false;  ///< upload_textures() before the renderer is made
};

/// `force`: passes to run although the scene does not call for them: "double-sided", "alpha-mask", "occlusion",
/// "hardware", "textures", "all". `has_colors`: the picture is resolved to colours.
/// Errors: kUsage for another name.
[[nodiscard]] Result<PassPlan> plan_passes(const GpuScene& scene, const DeviceInfo& device, std::uint32_t width,
                                           std::uint32_t height, const std::vector<std::string>& force = {},
                                           bool has_colors = false);

[[nodiscard]] std::string describe_plan(const PassPlan& plan);

}  // namespace meshlode::draw
