// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of files that say only that they have levels of 0 to 255.
#pragma once

#include <cstdint>

namespace meshlode::scene {

/// The linear value of a level of sRGB (IEC 61966-2-1), rounded to a float.
[[nodiscard]] float linear_of_srgb(std::uint8_t level);
/// The level itself, 0 to 1, or what is linear where it is one of sRGB.
[[nodiscard]] inline float color_of_level(std::uint8_t level, bool is_srgb) {
  return is_srgb ? linear_of_srgb(level) : static_cast<float>(level) / 255.0F;
}

}  // namespace meshlode::scene
