// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels of PNG, JPEG and WebP files, for who draws textures or makes them smaller (app/textures). The builder itself
// never looks at a pixel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

namespace meshlode::draw {

constexpr std::uint32_t kMaxTextureSide = 16384;

/// As the file has them: no colour profile and no gamma is applied (glTF 2.0, 3.8.3 forbids it).
struct DecodedImage {
  std::uint32_t width = 0, height = 0;
  /// red | green << 8 | blue << 16 | alpha << 24, top row first; alpha 255 where the file has none
  std::vector<std::uint32_t> texels;

  /// The same as 4 bytes a texel.
  [[nodiscard]] std::span<const std::uint8_t> rgba() const {
    return {reinterpret_cast<const std::uint8_t*>(texels.data()), 4 * texels.size()};
  }
};

/// What the first bytes of a file say.
struct ImageHeader {
  std::uint32_t width = 0, height = 0;
  /// What the library keeps beside the texels while it decodes: coefficients of a JPEG of several scans, pixels and
  /// planes of WebP. An upper bound.
  std::uint64_t decoder_bytes = 0;
};

/// Errors: as decode_image(), as far as the file's head shows them. An image of which this is known takes
/// 4 · width · height + decoder_bytes to decode.
[[nodiscard]] Result<ImageHeader> read_image_header(std::span<const std::uint8_t> bytes);

/// PNG of every kind (16-bit channels are scaled to 8), JPEG of grey or colour and WebP, by their first bytes. Safe on
/// any bytes: memory and time are bounded by what a file of this size can hold; a WebP of any size may hold 2^24
/// texels. Errors: kInvalid for a damaged file; kUnsupported for another format, a JPEG of four colours or with
/// arithmetic coding, an animated WebP, and more than kMaxTextureSide texels a side. `capacity`: texels that there is
/// room for, where that is more, so that what is appended need not move them.
[[nodiscard]] Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, std::uint64_t capacity = 0);

}  // namespace meshlode::draw
