// SPDX-License-Identifier: GPL-3.0-or-later
// The SPIR-V that was built from shaders/.
#pragma once

#include <cstdint>
#include <span>

namespace meshlode::draw::shaders {

[[nodiscard]] std::span<const std::uint32_t> instances();
[[nodiscard]] std::span<const std::uint32_t> traverse();
[[nodiscard]] std::span<const std::uint32_t> clusters();
[[nodiscard]] std::span<const std::uint32_t> raster();
[[nodiscard]] std::span<const std::uint32_t> raster_clip();
[[nodiscard]] std::span<const std::uint32_t> pyramid();
[[nodiscard]] std::span<const std::uint32_t> decode();
[[nodiscard]] std::span<const std::uint32_t> flat();
[[nodiscard]] std::span<const std::uint32_t> sort();
[[nodiscard]] std::span<const std::uint32_t> resolve();
[[nodiscard]] std::span<const std::uint32_t> resolve_textures();  ///< with base colour and normal textures
[[nodiscard]] std::span<const std::uint32_t> raster_far();
[[nodiscard]] std::span<const std::uint32_t> roots();
[[nodiscard]] std::span<const std::uint32_t> persistent();
[[nodiscard]] std::span<const std::uint32_t> hardware_vert();
[[nodiscard]] std::span<const std::uint32_t> hardware_mesh();
[[nodiscard]] std::span<const std::uint32_t> hardware_frag();
[[nodiscard]] std::span<const std::uint32_t> hardware_mesh_frag();  ///< behind a mesh shader
// The same with the alpha test of masked materials.
[[nodiscard]] std::span<const std::uint32_t> raster_mask();
[[nodiscard]] std::span<const std::uint32_t> raster_far_mask();
[[nodiscard]] std::span<const std::uint32_t> raster_clip_mask();
[[nodiscard]] std::span<const std::uint32_t> hardware_mask_frag();
[[nodiscard]] std::span<const std::uint32_t> hardware_mesh_mask_frag();

}  // namespace meshlode::draw::shaders
