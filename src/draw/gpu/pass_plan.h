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

/// What the choice of passes looks at: of a scene on a device, or of one that is not even built, whose counts are then
/// estimates.
struct PassFacts {
  std::uint32_t instance_count = 0;
  std::uint64_t cluster_instances = 0;  ///< clusters of all instances together
  std::uint32_t bvh_depth = 0;          ///< 0: not known yet
  bool has_single_root = false;         ///< a mesh has one root cluster alone
  bool has_double_sided = false;
  bool has_alpha_mask = false;
  bool has_textures = false;
};

/// `force`: passes to run although the scene does not call for them: "double-sided", "alpha-mask", "occlusion",
/// "hardware", "textures", "all". `has_colors`: the picture is resolved to colours.
/// Errors: kUsage for another name.
[[nodiscard]] Result<PassPlan> plan_passes(const GpuScene& scene, const DeviceInfo& device, std::uint32_t width,
                                           std::uint32_t height, const std::vector<std::string>& force = {},
                                           bool has_colors = false);

[[nodiscard]] Result<PassPlan> plan_passes(const PassFacts& scene, const DeviceInfo& device, std::uint32_t width,
                                           std::uint32_t height, const std::vector<std::string>& force,
                                           bool has_colors);

/// A line for each pass, with `indent` before it.
[[nodiscard]] std::string describe_plan(const PassPlan& plan, const std::string& indent = {});

}  // namespace meshlode::draw
