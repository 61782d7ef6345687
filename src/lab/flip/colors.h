// SPDX-License-Identifier: GPL-3.0-or-later
// The colour spaces that FLIP goes through. Linear sRGB has white at (1, 1, 1).
#pragma once

#include <cstdint>

#include "base/vec.h"

namespace meshlode::lab {

/// IEC 61966-2-1.
[[nodiscard]] double linear_of_srgb(std::uint8_t value);

/// Opponent space: luminance, red-green, blue-yellow; linear in the light, so that blurring in it is right.
[[nodiscard]] Vec3d ycxcz_of_linear(const Vec3d& rgb);
[[nodiscard]] Vec3d linear_of_ycxcz(const Vec3d& opponent);

/// CIE 1976 L*a*b* under D65, a* and b* scaled by L*/100: colours of dark places look less colourful (Hunt 1952).
[[nodiscard]] Vec3d hunt_lab_of_linear(const Vec3d& rgb);

/// The distance of large colour differences (Abasi, Tehran and Fairchild 2020).
[[nodiscard]] double hyab(const Vec3d& a, const Vec3d& b);

}  // namespace meshlode::lab
