// SPDX-License-Identifier: GPL-3.0-or-later
// An image with fewer texels: each is the mean of the area that it covers, as mip levels are made, for any ratio. The
// same bytes on every machine: doubles in a fixed order, and a table of sRGB.
#pragma once

#include <cstdint>
#include <utility>

#include "draw/textures/image.h"

namespace meshlode::app {

/// What texels mean.
enum class TexelKind : std::uint8_t {
  kColor,        ///< sRGB: averaged as light, and by alpha
  kOpaqueColor,  ///< the same where nothing asks for alpha: it has no weight
  kNormal,       ///< directions: averaged, then of length 1 again
  kData,         ///< each channel for itself
};

[[nodiscard]] constexpr bool is_color(TexelKind kind) {
  return kind == TexelKind::kColor || kind == TexelKind::kOpaqueColor;
}

/// So that the longer side has `longest` texels at most, the other in proportion and at least 1. Not larger than it is.
[[nodiscard]] std::pair<std::uint32_t, std::uint32_t> fit_size(std::uint32_t width, std::uint32_t height,
                                                               std::uint32_t longest);

/// \pre 1 <= width <= image.width and the same of the height
[[nodiscard]] draw::DecodedImage shrink(const draw::DecodedImage& image, std::uint32_t width, std::uint32_t height,
                                        TexelKind kind);

}  // namespace meshlode::app
