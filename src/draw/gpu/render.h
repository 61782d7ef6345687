// SPDX-License-Identifier: GPL-3.0-or-later
// One picture of an asset by a Vulkan device, from the file's pages to colours: what `render --gpu` does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "draw/raster/raster.h"
#include "draw/textures/image_budget.h"
#include "run/read/asset.h"
#include "run/select/attribute_bounds.h"
#include "run/select/select.h"

namespace meshlode::draw {

struct GpuRenderOptions {
  std::string device;      ///< as DeviceOptions: an index or a part of the name; empty: the first that can run
  std::uint32_t view = 0;  ///< a VIEW_… of shaders/frame.h
  double pixel_error = 1.0;
  run::AttributeBounds bounds;     ///< a group that deviates by more never passes
  std::vector<std::string> force;  ///< passes to run although the scene does not call for them: plan_passes()
  std::uint32_t frames = 1;        ///< drawn one after the other; the last one is read. \pre at least 1
};

struct GpuPicture {
  std::vector<run::ClusterInstance> cut;  ///< what was drawn, ascending
  VisibilityBuffer visibility;            ///< items are indices into `cut`
  Image image;
  std::vector<std::string> warnings;  ///< images that could not be read
  std::string plan;                   ///< which passes ran and why, a line each: describe_plan()
  std::string device;                 ///< its name
  double frame_milliseconds = 0.0;    ///< of the last frame's passes by the device's clock, without reading it back
};

/// Selects, draws and colours the cut of `camera`. `images`: what decoded masks and textures may take. Warnings and
/// plan of `out` are those of as far as it came, also where it fails. Errors: kUnsupported without a device, where it
/// has no room, or where the frame's lists overflow; kUsage for a pass or a device that there is not, and for a camera
/// as draw_cut(); kInvalid for a broken page.
[[nodiscard]] Status render_on_gpu(const run::Asset& asset, const run::Camera& camera, const GpuRenderOptions& options,
                                   ImageBudget& images, GpuPicture& out);

}  // namespace meshlode::draw
