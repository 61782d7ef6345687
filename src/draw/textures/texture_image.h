// SPDX-License-Identifier: GPL-3.0-or-later
// An image with its mip levels, sampled with a trilinear filter. Levels are averaged and texels are mixed in linear
// light where the image is sRGB. A GPU that is given the same levels samples the same up to its rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "draw/textures/image.h"
#include "draw/textures/texture_use.h"

namespace meshlode::draw {

struct TextureImage {
  std::uint32_t width = 0, height = 0;
  bool is_srgb = false;  ///< red, green and blue; alpha never is
  /// Level l is max(1, width >> l) × max(1, height >> l) texels from texels[first[l]] on, top row first; the last is
  /// one texel. A texel is red | green << 8 | blue << 16 | alpha << 24.
  std::vector<std::size_t> first;
  std::vector<std::uint32_t> texels;

  [[nodiscard]] std::uint32_t level_count() const { return static_cast<std::uint32_t>(first.size()); }
  [[nodiscard]] std::uint32_t width_of(std::uint32_t level) const { return std::max(1u, width >> level); }
  [[nodiscard]] std::uint32_t height_of(std::uint32_t level) const { return std::max(1u, height >> level); }
};

/// The image's texels become level 0 where they lie: decode_image() with count_mip_texels() leaves room for the others.
[[nodiscard]] TextureImage make_texture_image(DecodedImage image, bool is_srgb);

/// Texels of all levels. \pre both sides are at least 1
[[nodiscard]] std::uint64_t count_mip_texels(std::uint32_t width, std::uint32_t height);

/// Where a pixel looks at a texture, and how far the next pixels to the right and below look from there. UV units.
struct TextureFootprint {
  std::array<double, 2> at{}, right{}, down{};
};

/// The mip level whose texels are as large as the footprint's longer step, 0 … level_count - 1.
[[nodiscard]] double level_of_detail(const TextureImage& image, const TextureFootprint& footprint);

/// Linear red, green, blue and alpha, 0 … 1.
[[nodiscard]] std::array<double, 4> sample_texture(const TextureImage& image, Wrap wrap_u, Wrap wrap_v,
                                                   const TextureFootprint& footprint);

/// Texel `i` of an endless row in one of `count`. \pre count > 0
[[nodiscard]] std::uint32_t wrap_texel(std::int64_t i, std::uint32_t count, Wrap wrap);
/// The texel of `count` that a place in texels lies in: any number, and where it is none the first.
[[nodiscard]] inline std::uint32_t texel_at(double place, std::uint32_t count, Wrap wrap) {
  if (place >= 0.0 && place < count) return static_cast<std::uint32_t>(place);  // most are, whatever is beside it
  constexpr double kFar = 1e15;
  if (!(std::fabs(place) < kFar)) place = std::isnan(place) ? 0.0 : std::copysign(kFar, place);
  return wrap_texel(static_cast<std::int64_t>(std::floor(place)), count, wrap);
}

}  // namespace meshlode::draw
