// SPDX-License-Identifier: GPL-3.0-or-later
// Images as files: each library is seen by one file. The same bytes for the same texels and library.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/result.h>

#include "draw/textures/image.h"

namespace meshlode::app {

constexpr std::uint32_t kMostWebpSide = 16383;  ///< WEBP_MAX_DIMENSION

/// With as few channels of 8 bits as tell the texels apart. Errors: kBuildFailed, out of memory.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_png_file(const draw::DecodedImage& image);
/// Without alpha, every channel with as many samples as texels. `quality`: 1 to 100.
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_jpeg_file(const draw::DecodedImage& image, int quality);
/// `quality`: 1 to 100, 0: without loss. Colours below transparent texels stay. The image is in use meanwhile, and the
/// same afterwards. \pre sides of at most kMostWebpSide
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_webp_file(draw::DecodedImage& image, std::uint32_t quality);

}  // namespace meshlode::app
