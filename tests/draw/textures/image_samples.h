// SPDX-License-Identifier: GPL-3.0-or-later
// PNG, JPEG and WebP files of every kind that the reader takes, written by the libraries' encoders.
#pragma once

#include <cstdint>
#include <vector>

namespace meshlode::test {

struct PngKind {
  int color_type = 6;  ///< as the PNG specification numbers them
  int bit_depth = 8;
  bool is_interlaced = false;
  bool has_transparency = false;  ///< tRNS
};
/// Pixel bytes as PNG has them: rows of `bit_depth` fields, high bits first, rows from whole bytes on.
[[nodiscard]] std::vector<std::uint8_t> make_png(std::uint32_t width, std::uint32_t height, const PngKind& kind,
                                                 const std::vector<std::uint8_t>& rows);
/// Entry i of the palette that colour type 3 gets, and its alpha where there is tRNS.
struct PaletteEntry {
  std::uint8_t r, g, b, a;
};
[[nodiscard]] PaletteEntry palette_entry(std::uint32_t i);

/// `components` bytes a pixel: 1 grey, 3 RGB, 4 CMYK.
[[nodiscard]] std::vector<std::uint8_t> make_jpeg(std::uint32_t width, std::uint32_t height, int components,
                                                  bool is_progressive, const std::vector<std::uint8_t>& pixels);

/// Four bytes a pixel.
[[nodiscard]] std::vector<std::uint8_t> make_webp(std::uint32_t width, std::uint32_t height, bool is_lossless,
                                                  const std::vector<std::uint8_t>& pixels);

}  // namespace meshlode::test
