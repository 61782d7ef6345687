// SPDX-License-Identifier: GPL-3.0-or-later
// Small procedural textures as PNG bytes.
#pragma once

#include <cstdint>
#include <vector>

namespace meshlode::lab {

struct Texture {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< top row first
};

/// Speckled grey-brown stone.
[[nodiscard]] Texture make_stone_texture(std::uint32_t size);
/// Grass green to rock by noise.
[[nodiscard]] Texture make_ground_texture(std::uint32_t size);
/// Furrows along v in brown bark, which tiles along both.
[[nodiscard]] Texture make_bark_texture(std::uint32_t size);
/// A leaf with a stem: alpha 255 inside, 0 outside, a ramp of one pixel between.
[[nodiscard]] Texture make_leaf_texture(std::uint32_t size);

[[nodiscard]] std::vector<std::uint8_t> encode_png(const Texture& texture);

}  // namespace meshlode::lab
