// SPDX-License-Identifier: GPL-3.0-or-later
// A picture drawn by hardware against what the specification leaves free (V407, V408), pixel by pixel.
#pragma once

#include <cstdint>
#include <span>

#include <meshlode/result.h>

#include "judge/gpu/compare_frame.h"

namespace meshlode::judge {

/// Each pixel of `drawn`, whose items are indices into `cut`:
///  - the triangle that it names may cover its centre, and has the pixel's depth somewhere within reach of it;
///  - nothing lies nearer that covers the centre whatever the freedom: neither one triangle, nor triangles joined by
///  the
///    edges that pass within reach.
/// `items` of the answer are the pixels that something covers in the CPU's picture. `subpixel_bits`: the device's.
[[nodiscard]] Result<Comparison> judge_hardware_pixels(const run::Asset& asset,
                                                       std::span<const run::ClusterInstance> cut,
                                                       const draw::VisibilityBuffer& drawn, const run::Camera& camera,
                                                       const draw::AlphaMasks& masks, std::uint32_t subpixel_bits);

/// Draws the whole cut by a `renderer` with a hardware path and no culling, everything in hardware, and judges its
/// pixels. A cut that is not the CPU's is a difference too. `subpixel_bits`: DeviceInfo's.
[[nodiscard]] Result<Comparison> compare_hardware(draw::Renderer& renderer, const run::Asset& asset,
                                                  const run::Camera& camera, double pixel_error,
                                                  std::uint32_t subpixel_bits);

}  // namespace meshlode::judge
