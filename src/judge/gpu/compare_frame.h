// SPDX-License-Identifier: GPL-3.0-or-later
// The GPU against the CPU (I8, I9): decoded integers, the cut, and each pixel's id and depth.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "draw/gpu/gpu_scene.h"
#include "draw/gpu/renderer.h"
#include "draw/gpu/vulkan/vulkan.h"
#include "judge/gpu/picture_distance.h"
#include "run/select/select.h"

namespace meshlode::judge {

/// What was compared, and where it differed.
struct Comparison {
  std::uint64_t items = 0;
  std::uint64_t differences = 0;
  std::string first;  ///< the first difference, in words
};

/// Every integer of every cluster (I9).
[[nodiscard]] Result<Comparison> compare_decode(draw::Device& device, const draw::GpuScene& scene,
                                                const run::Asset& asset);

struct CutComparison {
  Comparison cut;     ///< without culling: equal to the flat rule's (I8). With culling: a part of it
  Comparison pixels;  ///< ids and depths against the CPU's picture of the whole cut (I9)
  draw::FrameReport frame;
};
/// Draws with `renderer` and compares with select_flat() and draw_cut() of the same camera. With culling the picture
/// must still be the same: what is culled would not have been seen. `bounds` are those that the scene was uploaded
/// with.
[[nodiscard]] Result<CutComparison> compare_frame(draw::Renderer& renderer, const run::Asset& asset,
                                                  const run::Camera& camera, double pixel_error,
                                                  const run::AttributeBounds& bounds = {});

/// Adds what differs between the last frame of `renderer`, whose cut was `cut`, and the CPU's picture of `expected`.
[[nodiscard]] Status compare_pixels(draw::Renderer& renderer, const run::Asset& asset, const run::Camera& camera,
                                    std::span<const run::ClusterInstance> cut,
                                    std::span<const run::ClusterInstance> expected, Comparison& out);

struct HardwareComparison {
  bool is_same_cut = false;  ///< as the flat rule's
  PictureDistance picture;   ///< from draw_cut()'s of that
};
/// Draws the whole cut by a `renderer` with a hardware path and no culling, everything in hardware (V409).
[[nodiscard]] Result<HardwareComparison> compare_hardware(draw::Renderer& renderer, const run::Asset& asset,
                                                          const run::Camera& camera, double pixel_error);

}  // namespace meshlode::judge
