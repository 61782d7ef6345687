// SPDX-License-Identifier: GPL-3.0-or-later
// stb_image_write, seen by this file alone in this room. Its compressor works on integers: the bytes are the same
// everywhere.
#include "lab/samples/write_png.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#include <stb_image_write.h>

#include "lab/samples/noise.h"

namespace meshlode::lab {

namespace {

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::floor(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5));
}

template <class Color>
Texture paint(std::uint32_t size, const Color& color) {
  Texture texture{size, size, {}};
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = 0; x < size; ++x) {
      const glm::dvec4 c = color((x + 0.5) / size, (y + 0.5) / size);
      for (int k = 0; k < 4; ++k) texture.rgba.push_back(to_byte(c[k]));
    }
  }
  return texture;
}

}  // namespace

Texture make_stone_texture(std::uint32_t size) {
  return paint(size, [](double u, double v) {
    const double body = fractal_noise({u * 8.0, v * 8.0, 0.25}, 4, 21);
    const double speck = value_noise({u * 40.0, v * 40.0, 0.5}, 22) > 0.55 ? 0.12 : 0.0;
    const double g = 0.5 + 0.25 * body - speck;
    return glm::dvec4(g * 1.05, g, g * 0.92, 1.0);
  });
}

Texture make_ground_texture(std::uint32_t size) {
  return paint(size, [](double u, double v) {
    const double n = 0.5 + 0.5 * fractal_noise({u * 6.0, v * 6.0, 0.75}, 5, 31);
    return glm::dvec4(0.25 + 0.25 * n, 0.42 + 0.12 * n, 0.18 + 0.16 * n, 1.0);
  });
}

Texture make_bark_texture(std::uint32_t size) {
  // Noise on a torus, so that neither edge is seen.
  return paint(size, [](double u, double v) {
    const Vec3d round(1.5 * cos_turns(u), 1.5 * sin_turns(u), 0.0), high(0.0, 0.3 * cos_turns(v), 0.3 * sin_turns(v));
    const double bend = 0.15 * value_noise(round * 0.7 + high * 3.0, 41);
    const double furrow = 0.5 + 0.5 * sin_turns(9.0 * u + 9.0 * bend);
    const double grain = fractal_noise(round * 6.0 + high * 5.0, 3, 42);
    const double g = 0.16 + 0.34 * furrow + 0.14 * grain;
    return glm::dvec4(g * 1.2, g * 0.92, g * 0.7, 1.0);
  });
}

Texture make_leaf_texture(std::uint32_t size) {
  return paint(size, [size](double u, double v) {
    const double y = 1.0 - v, x = (u - 0.5 < 0.0 ? 0.5 - u : u - 0.5);
    const double leaf = 1.6 * (y - 0.12) * (0.98 - y), stem = y < 0.3 ? 0.03 : 0.0;
    const double inside = std::max(leaf, stem) - x;
    const double vein = x < 0.02 ? 0.15 : 0.0;
    return glm::dvec4(0.16 + vein, 0.42 + 0.2 * y + vein, 0.1, std::clamp(inside * size + 0.5, 0.0, 1.0));
  });
}

std::vector<std::uint8_t> encode_png(const Texture& texture) {
  int bytes = 0;
  unsigned char* png =
      stbi_write_png_to_mem(texture.rgba.data(), static_cast<int>(texture.width * 4), static_cast<int>(texture.width),
                            static_cast<int>(texture.height), 4, &bytes);
  std::vector<std::uint8_t> out(png, png + bytes);
  std::free(png);
  return out;
}

}  // namespace meshlode::lab
