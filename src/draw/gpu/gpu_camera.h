// SPDX-License-Identifier: GPL-3.0-or-later
// A camera as the shaders see it.
#pragma once

#include <meshlode/result.h>

#include "draw/gpu/shaders/frame.h"
#include "run/read/asset.h"
#include "run/select/select.h"

namespace meshlode::draw {

/// `scene_depth` is raster's for the same camera: where orthographic depth is 0; unused in perspective.
/// Errors: kUsage, as make_projection().
[[nodiscard]] Result<GpuCamera> make_gpu_camera(const run::Camera& camera, double pixel_error, double scene_depth);

/// scene_depth() over instances that need not be the asset's; 0 for perspective cameras, which do not ask.
[[nodiscard]] Result<double> depth_of_scene(const run::Asset& asset, const run::Camera& camera);

}  // namespace meshlode::draw
