// SPDX-License-Identifier: GPL-3.0-or-later
// V109 of images that `--textures` converted: the asset says by what, and what it shows must be the source's.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace meshlode::judge {

/// How the asset says that its images were made: `textures` of META's settings, read by lines of its own.
struct StatedTextures {
  std::uint32_t longest_side = 0;  ///< 0: as many texels as there were
  bool has_webp = false;
  [[nodiscard]] bool is_any() const { return longest_side != 0 || has_webp; }
};
[[nodiscard]] StatedTextures read_stated_textures(std::string_view words);

/// Why these bytes are not the source's image under what was stated; empty where they are. Both are decoded, unless
/// they are equal.
[[nodiscard]] std::string find_image_fault(std::span<const std::uint8_t> stored, std::string_view mime_type,
                                           const scene::SceneBlob& source, const StatedTextures& stated);

}  // namespace meshlode::judge
