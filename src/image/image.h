// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of PNG and JPEG files, for who draws textures. The build never looks at a pixel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode {

constexpr std::uint32_t kMaxTextureSide = 16384;

/// As the file has them: no colour profile and no gamma is applied (glTF 2.0, 3.8.3 forbids it).
struct DecodedImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 bytes a texel, top row first; alpha 255 where the file has none
};

/// PNG of every kind (16-bit channels are scaled to 8) and JPEG of grey or colour, by their first bytes. Safe on any
/// bytes: memory and time are bounded by what a file of this size can hold.
/// Errors: kInvalid for a damaged file; kUnsupported for another format, a JPEG of four colours or with arithmetic coding,
/// and more than kMaxTextureSide texels a side.
[[nodiscard]] Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes);

}  // namespace meshlode
