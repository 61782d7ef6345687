// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of the views, and the legend of the levels.
#pragma once

#include <array>
#include <cstdint>

#include "draw/raster/raster.h"

namespace meshlode::draw {

using Rgb = std::array<double, 3>;  ///< linear, 0 … 1

/// A bright colour that depends on nothing but the numbers.
[[nodiscard]] Rgb hash_color(std::uint32_t a, std::uint32_t b);
/// From blue (level 0) over green and yellow to red (the coarsest).
[[nodiscard]] Rgb level_color(std::uint32_t level, std::uint32_t level_count);
/// Squares with the levels' colours and numbers in the lower left corner, if there is room.
void draw_level_legend(Image& image, std::uint32_t level_count);

/// One linear channel as a byte, with a square root for the display's curve (gamma 2, no math library).
[[nodiscard]] std::uint8_t to_display(double linear);

}  // namespace meshlode::draw
