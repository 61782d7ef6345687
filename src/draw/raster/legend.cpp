// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/raster/legend.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace meshlode::draw {

namespace {

/// Digits of 3 × 5 pixels, a row in three bits from the left.
constexpr std::uint8_t kDigits[10][5] = {
    {7, 5, 5, 5, 7}, {2, 6, 2, 2, 7}, {7, 1, 7, 4, 7}, {7, 1, 7, 1, 7}, {5, 5, 7, 1, 1},
    {7, 4, 7, 1, 7}, {7, 4, 7, 5, 7}, {7, 1, 1, 1, 1}, {7, 5, 7, 5, 7}, {7, 5, 7, 1, 7},
};

void put(Image& image, std::uint32_t x, std::uint32_t y, const Rgb& color) {
  const std::size_t at = 4 * (std::size_t{y} * image.width + x);
  for (std::size_t k = 0; k < 3; ++k) image.rgba[at + k] = to_display(color[k]);
}

void draw_digit(Image& image, std::uint32_t left, std::uint32_t top, std::uint32_t digit, std::uint32_t scale) {
  for (std::uint32_t y = 0; y < 5 * scale; ++y) {
    for (std::uint32_t x = 0; x < 3 * scale; ++x) {
      if ((kDigits[digit][y / scale] >> (2 - x / scale) & 1) != 0) put(image, left + x, top + y, {0.0, 0.0, 0.0});
    }
  }
}

}  // namespace

Rgb hash_color(std::uint32_t a, std::uint32_t b) {
  const std::uint64_t z = mix64((std::uint64_t{a} << 32 | b) + kGoldenGamma);
  // A hue around the wheel, saturation and value in the upper half.
  const double hue = static_cast<double>(z & 0xFFFF) / 65536.0 * 6.0;
  const double saturation = 0.45 + 0.4 * static_cast<double>(z >> 16 & 0xFF) / 255.0;
  const double value = 0.55 + 0.45 * static_cast<double>(z >> 24 & 0xFF) / 255.0;
  Rgb out;
  for (std::size_t k = 0; k < 3; ++k) {
    double distance = std::abs(hue - 2.0 * static_cast<double>(k));
    distance = std::min(distance, 6.0 - distance);
    out[k] = value * (1.0 - saturation * std::clamp(distance - 1.0, 0.0, 1.0));
  }
  return out;
}

Rgb level_color(std::uint32_t level, std::uint32_t level_count) {
  static constexpr Rgb kStops[5] = {
      {0.05, 0.12, 0.75}, {0.05, 0.6, 0.8}, {0.15, 0.65, 0.1}, {0.9, 0.75, 0.05}, {0.8, 0.06, 0.04}};
  const double t = level_count < 2 ? 0.0 : 4.0 * std::min(level, level_count - 1) / (level_count - 1);
  const auto stop = std::min<std::size_t>(3, static_cast<std::size_t>(t));
  const double s = t - static_cast<double>(stop);
  Rgb out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = kStops[stop][k] * (1.0 - s) + kStops[stop + 1][k] * s;
  return out;
}

void draw_level_legend(Image& image, std::uint32_t level_count) {
  const std::uint32_t scale = image.height >= 480 ? 2 : 1, side = 9 * scale, gap = 2 * scale;
  if (image.width < gap + level_count * (side + gap) || image.height < side + 2 * gap) return;
  const std::uint32_t top = image.height - gap - side;
  for (std::uint32_t level = 0; level < level_count; ++level) {
    const std::uint32_t left = gap + level * (side + gap);
    Rgb color = level_color(level, level_count);
    for (double& c : color) c = 0.35 + 0.65 * c;  // lighter, so that the number is read
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) put(image, left + x, top + y, color);
    }
    if (level < 10) {
      draw_digit(image, left + 3 * scale, top + 2 * scale, level, scale);
    } else {
      draw_digit(image, left + scale, top + 2 * scale, level / 10 % 10, scale);
      draw_digit(image, left + 5 * scale, top + 2 * scale, level % 10, scale);
    }
  }
}

std::uint8_t to_display(double linear) {
  return static_cast<std::uint8_t>(std::floor(std::sqrt(std::clamp(linear, 0.0, 1.0)) * 255.0 + 0.5));
}

}  // namespace meshlode::draw
