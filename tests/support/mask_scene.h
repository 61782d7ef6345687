// SPDX-License-Identifier: GPL-3.0-or-later
// Nine masked cards, one for each pair of wrap modes, before an opaque wall that is seen through their holes.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace meshlode::test {

struct MaskSceneOptions {
  float cutoff = 0.5F, factor = 1.0F;
  bool has_vertex_alpha = false;  ///< falls from 1 to 0 across a card
  bool has_texture = true;
  std::string transform{};            ///< KHR_texture_transform's JSON object; empty: none
  std::vector<std::uint8_t> image{};  ///< a file; empty: mask_texture() as PNG
  std::uint32_t cells = 6;            ///< along a card's side
};

/// Alpha of texel (x, y) of the generated texture: every value from 0 to 255 occurs.
constexpr std::uint32_t kMaskTextureWidth = 23, kMaskTextureHeight = 17;
[[nodiscard]] std::uint8_t mask_texture_alpha(std::uint32_t x, std::uint32_t y);

/// glTF's names of the wrap modes of card k: wrap_names[k % 3] for u, wrap_names[k / 3] for v.
constexpr std::array<std::uint32_t, 3> kWrapNames{10497, 33648, 33071};  // repeat, mirrored repeat, clamp to edge

/// Material 0 is the wall's, 1 + k card k's. UVs run from -1.7 to 2.6.
[[nodiscard]] scene::Scene mask_scene(const MaskSceneOptions& options);
/// The asset of a scene; fails the test and returns nothing where it cannot be built.
[[nodiscard]] std::vector<std::uint8_t> built(const scene::Scene& scene);

}  // namespace meshlode::test
