// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/textures/shrink.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "scene/import/polygons/display_levels.h"

namespace meshlode::app {

namespace {

/// Red, green, blue, alpha, and what the colours are weighted by.
using Texel = std::array<double, 5>;

/// Where nothing is opaque colours count as much as each other, and else next to nothing: a thousandth of one level.
constexpr double kLeastAlpha = 1e-3 / 255.0;
/// Normals of 8 bits are off by half a level along each axis: a mean that is shorter than that says nothing.
constexpr double kShortestNormal = 1.0 / 128.0;

const std::array<double, 256>& linear_levels() {
  static const std::array<double, 256> levels = [] {
    std::array<double, 256> out{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = double{scene::linear_of_srgb(static_cast<std::uint8_t>(i))};
    return out;
  }();
  return levels;
}

/// The level whose light is nearest.
std::uint32_t level_of_light(double light) {
  const auto& levels = linear_levels();
  const auto above = std::lower_bound(levels.begin(), levels.end(), light);
  if (above == levels.begin()) return 0;
  if (above == levels.end()) return 255;
  const auto index = static_cast<std::uint32_t>(above - levels.begin());
  return light - levels[index - 1] < levels[index] - light ? index - 1 : index;
}

std::uint32_t level_of(double value) {
  return static_cast<std::uint32_t>(std::floor(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5));
}

/// As it is summed up.
Texel unpack_texel(std::uint32_t packed, TexelKind kind) {
  Texel out{};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t level = packed >> 8U * k & 255U;
    out[k] = is_color(kind) && k < 3 ? linear_levels()[level] : level / 255.0;
  }
  if (!is_color(kind)) return out;
  out[4] = kind == TexelKind::kColor ? out[3] + kLeastAlpha : 1.0;
  for (std::size_t k = 0; k < 3; ++k) out[k] *= out[4];
  return out;
}

std::uint32_t pack_texel(Texel texel, TexelKind kind) {
  if (kind == TexelKind::kNormal) {
    std::array<double, 3> n{};
    double square = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      n[k] = 2.0 * texel[k] - 1.0;
      square += n[k] * n[k];
    }
    const double length = std::sqrt(square);
    const bool is_some = length > kShortestNormal;
    if (!is_some) n = {0.0, 0.0, 1.0};  // the surface's own
    for (std::size_t k = 0; k < 3; ++k) texel[k] = 0.5 + 0.5 * (is_some ? n[k] / length : n[k]);
  }
  std::uint32_t out = level_of(texel[3]) << 24U;
  for (std::size_t k = 0; k < 3; ++k) {
    out |= (is_color(kind) ? level_of_light(texel[k] / texel[4]) : level_of(texel[k])) << 8U * k;
  }
  return out;
}

/// The texels of a row of `fine` that one of `coarse` covers, and how much of each: in parts of 1 / coarse, which are
/// whole numbers.
struct Cover {
  std::uint32_t first = 0;
  std::vector<double> shares;  ///< their sum is 1
};

std::vector<Cover> covers_of(std::uint32_t fine, std::uint32_t coarse) {
  std::vector<Cover> covers(coarse);
  for (std::uint64_t i = 0; i < coarse; ++i) {
    const std::uint64_t begin = i * fine, end = begin + fine;
    covers[i].first = static_cast<std::uint32_t>(begin / coarse);
    for (std::uint64_t s = covers[i].first; s * coarse < end; ++s) {
      const std::uint64_t part = std::min((s + 1) * coarse, end) - std::max(s * coarse, begin);
      covers[i].shares.push_back(static_cast<double>(part) / fine);
    }
  }
  return covers;
}

}  // namespace

std::pair<std::uint32_t, std::uint32_t> fit_size(std::uint32_t width, std::uint32_t height, std::uint32_t longest) {
  const std::uint64_t most = std::max(width, height);
  if (longest == 0 || most <= longest) return {width, height};
  const auto fit = [&](std::uint64_t side) {
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (side * longest + most / 2) / most));
  };
  return {fit(width), fit(height)};
}

draw::DecodedImage shrink(const draw::DecodedImage& image, std::uint32_t width, std::uint32_t height, TexelKind kind) {
  const std::vector<Cover> columns = covers_of(image.width, width), rows = covers_of(image.height, height);
  draw::DecodedImage out;
  out.width = width;
  out.height = height;
  out.texels.resize(std::size_t{width} * height);
  parallel_for_each_index(height, 1, [&](std::size_t y) {
    std::vector<Texel> sums(width, Texel{});
    for (std::size_t j = 0; j < rows[y].shares.size(); ++j) {
      const std::uint32_t* const row = image.texels.data() + std::size_t{rows[y].first + j} * image.width;
      for (std::size_t x = 0; x < width; ++x) {
        for (std::size_t i = 0; i < columns[x].shares.size(); ++i) {
          const Texel texel = unpack_texel(row[columns[x].first + i], kind);
          const double share = rows[y].shares[j] * columns[x].shares[i];
          for (std::size_t k = 0; k < 5; ++k) sums[x][k] += share * texel[k];
        }
      }
    }
    for (std::size_t x = 0; x < width; ++x) out.texels[y * width + x] = pack_texel(sums[x], kind);
  });
  return out;
}

}  // namespace meshlode::app
