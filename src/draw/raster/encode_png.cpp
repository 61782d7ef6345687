// SPDX-License-Identifier: GPL-3.0-or-later
// stb_image_write, seen by this file alone in this room. Its compressor works on integers: the bytes are the same
// everywhere.
#include <cstdlib>
#include <limits>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

#include "draw/raster/raster.h"

namespace meshlode::draw {

std::vector<std::uint8_t> encode_png(const Image& image) {
  const std::size_t pixels = std::size_t{image.width} * image.height;
  bool is_opaque = true;
  for (std::size_t i = 0; i < pixels; ++i) is_opaque = is_opaque && image.rgba[4 * i + 3] == 255;
  const int channels = is_opaque ? 3 : 4;
  std::vector<std::uint8_t> packed;
  if (is_opaque) {
    packed.resize(3 * pixels);
    for (std::size_t i = 0; i < 3 * pixels; ++i) packed[i] = image.rgba[i / 3 * 4 + i % 3];
  }
  int bytes = 0;
  unsigned char* png =
      stbi_write_png_to_mem(is_opaque ? packed.data() : image.rgba.data(), static_cast<int>(image.width) * channels,
                            static_cast<int>(image.width), static_cast<int>(image.height), channels, &bytes);
  if (png == nullptr) return {};
  std::vector<std::uint8_t> out(png, png + bytes);
  std::free(png);
  return out;
}

}  // namespace meshlode::draw
