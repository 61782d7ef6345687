// SPDX-License-Identifier: GPL-3.0-or-later
// What becomes of the scene's images, as words: `keep`, `resize:1024`, `webp`, `webp:80`, `resize:1024,webp`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshlode::builder {

constexpr std::uint32_t kMostTextureSide = 16384;  ///< what is decoded
constexpr std::uint32_t kUsualWebpQuality = 90;    ///< docs/guides/choosing-settings.md has what others give

struct TextureChoice {
  std::uint32_t longest_side = 0;  ///< texels that an image has at most along its longer side; 0: as many as it has
  std::uint32_t webp_quality = 0;  ///< of colours, 1 to 100; 0: the formats stay

  [[nodiscard]] bool is_keep() const { return longest_side == 0 && webp_quality == 0; }
  bool operator==(const TextureChoice&) const = default;
};

/// Nothing for what is no choice, or says one thing twice.
[[nodiscard]] std::optional<TextureChoice> parse_texture_choice(std::string_view text);
/// In one form: "resize:1024,webp:90".
[[nodiscard]] std::string texture_word(const TextureChoice& choice);

}  // namespace meshlode::builder
