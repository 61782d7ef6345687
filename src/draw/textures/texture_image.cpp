// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/texture_image.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace meshlode::draw {

namespace {

/// IEC 61966-2-1.
double linear_of_srgb(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double srgb_of_linear(double c) {
  return c <= 0.0031308 ? c * 12.92 : 1.055 * std::pow(c, 1.0 / 2.4) - 0.055;
}

struct SrgbTables {
  std::array<float, 256> linear{};
  std::vector<std::uint8_t> byte;  ///< of a linear value times kSteps
  static constexpr std::uint32_t kSteps = 65535;

  SrgbTables() : byte(kSteps + 1) {
    for (std::size_t i = 0; i < linear.size(); ++i)
      linear[i] = static_cast<float>(linear_of_srgb(static_cast<double>(i) / 255.0));
    for (std::size_t i = 0; i < byte.size(); ++i) {
      byte[i] = static_cast<std::uint8_t>(std::floor(srgb_of_linear(static_cast<double>(i) / kSteps) * 255.0 + 0.5));
    }
  }
};

const SrgbTables& srgb_tables() {
  static const SrgbTables tables;
  return tables;
}

using Texel = std::array<float, 4>;

Texel linear_texel(std::uint32_t packed, bool is_srgb) {
  Texel out;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t byte = packed >> 8 * k & 255u;
    out[k] = is_srgb && k < 3 ? srgb_tables().linear[byte] : static_cast<float>(byte) / 255.0F;
  }
  return out;
}

std::uint32_t packed_texel(const Texel& linear, bool is_srgb) {
  std::uint32_t out = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double c = std::clamp(static_cast<double>(linear[k]), 0.0, 1.0);
    const auto step = static_cast<std::size_t>(std::floor(c * SrgbTables::kSteps + 0.5));
    const std::uint32_t byte =
        is_srgb && k < 3 ? srgb_tables().byte[step] : static_cast<std::uint32_t>(std::floor(c * 255.0 + 0.5));
    out |= byte << 8 * k;
  }
  return out;
}

/// The texels of the finer level that one of the coarser covers along an axis, and their shares: two of an even length,
/// three of an odd one.
struct Taps {
  std::uint32_t first = 0, count = 1;
  std::array<float, 3> share{1.0F, 0.0F, 0.0F};
};

Taps taps_of(std::uint32_t i, std::uint32_t fine, std::uint32_t coarse) {
  if (fine == coarse) return {i, 1, {1.0F, 0.0F, 0.0F}};
  if (fine % 2 == 0) return {2 * i, 2, {0.5F, 0.5F, 0.0F}};
  const auto n = static_cast<float>(coarse), at = static_cast<float>(i), whole = 2.0F * n + 1.0F;
  return {2 * i, 3, {(n - at) / whole, n / whole, (at + 1.0F) / whole}};
}

void add_level(TextureImage& image, std::uint32_t level) {
  const std::uint32_t fine_width = image.width_of(level - 1), fine_height = image.height_of(level - 1);
  const std::uint32_t width = image.width_of(level), height = image.height_of(level);
  const std::size_t fine = image.first[level - 1];
  image.first.push_back(image.texels.size());
  for (std::uint32_t y = 0; y < height; ++y) {
    const Taps rows = taps_of(y, fine_height, height);
    for (std::uint32_t x = 0; x < width; ++x) {
      const Taps columns = taps_of(x, fine_width, width);
      Texel sum{};
      for (std::uint32_t j = 0; j < rows.count; ++j) {
        for (std::uint32_t i = 0; i < columns.count; ++i) {
          const std::size_t at = fine + std::size_t{rows.first + j} * fine_width + columns.first + i;
          const Texel texel = linear_texel(image.texels[at], image.is_srgb);
          const float share = rows.share[j] * columns.share[i];
          for (std::size_t k = 0; k < 4; ++k) sum[k] += share * texel[k];
        }
      }
      image.texels.push_back(packed_texel(sum, image.is_srgb));
    }
  }
}

/// Between four texels of a level.
std::array<double, 4> sample_level(const TextureImage& image, std::uint32_t level, Wrap wrap_u, Wrap wrap_v,
                                   const std::array<double, 2>& at) {
  constexpr double kFarthest = 1e12;  // texels from the origin: farther ones count as there
  const std::uint32_t size[2] = {image.width_of(level), image.height_of(level)};
  const Wrap wrap[2] = {wrap_u, wrap_v};
  std::uint32_t texel[2][2];
  double share[2];
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double scaled = at[axis] * size[axis] - 0.5;
    const double place = std::abs(scaled) <= kFarthest ? scaled : 0.0;
    const double low = std::floor(place);
    share[axis] = place - low;
    for (std::int64_t k = 0; k < 2; ++k) {
      texel[axis][k] = wrap_texel(static_cast<std::int64_t>(low) + k, size[axis], wrap[axis]);
    }
  }
  std::array<double, 4> out{};
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t i = 0; i < 2; ++i) {
      const std::size_t index = image.first[level] + std::size_t{texel[1][j]} * size[0] + texel[0][i];
      const Texel c = linear_texel(image.texels[index], image.is_srgb);
      const double weight = (i == 0 ? 1.0 - share[0] : share[0]) * (j == 0 ? 1.0 - share[1] : share[1]);
      for (std::size_t k = 0; k < 4; ++k) out[k] += weight * static_cast<double>(c[k]);
    }
  }
  return out;
}

}  // namespace

TextureImage make_texture_image(DecodedImage image, bool is_srgb) {
  TextureImage out;
  out.width = image.width;
  out.height = image.height;
  out.is_srgb = is_srgb;
  out.texels = std::move(image.texels);
  out.texels.reserve(count_mip_texels(out.width, out.height));
  out.first.push_back(0);
  for (std::uint32_t level = 1; std::max(out.width, out.height) >> level > 0; ++level) add_level(out, level);
  return out;
}

std::uint64_t count_mip_texels(std::uint32_t width, std::uint32_t height) {
  std::uint64_t sum = 0;
  for (std::uint32_t level = 0; std::max(width, height) >> level > 0; ++level) {
    sum += std::uint64_t{std::max(1u, width >> level)} * std::max(1u, height >> level);
  }
  return sum;
}

double level_of_detail(const TextureImage& image, const TextureFootprint& footprint) {
  double longest2 = 0.0;
  for (const std::array<double, 2>& step : {footprint.right, footprint.down}) {
    const double u = step[0] * image.width, v = step[1] * image.height;
    longest2 = std::max(longest2, u * u + v * v);
  }
  const double most = image.level_count() - 1.0;
  if (!(longest2 > 1.0)) return 0.0;
  return longest2 < 1e300 ? std::min(0.5 * std::log2(longest2), most) : most;
}

std::array<double, 4> sample_texture(const TextureImage& image, Wrap wrap_u, Wrap wrap_v,
                                     const TextureFootprint& footprint) {
  const double level = level_of_detail(image, footprint);
  const auto fine = static_cast<std::uint32_t>(level);
  const double share = level - fine;
  std::array<double, 4> out = sample_level(image, fine, wrap_u, wrap_v, footprint.at);
  if (share == 0.0) return out;
  const std::array<double, 4> coarse = sample_level(image, fine + 1, wrap_u, wrap_v, footprint.at);
  for (std::size_t k = 0; k < 4; ++k) out[k] += share * (coarse[k] - out[k]);
  return out;
}

std::uint32_t wrap_texel(std::int64_t i, std::uint32_t count, Wrap wrap) {
  const std::int64_t n = count;
  if (wrap == Wrap::kClamp) return static_cast<std::uint32_t>(std::clamp<std::int64_t>(i, 0, n - 1));
  const std::int64_t period = wrap == Wrap::kMirror ? 2 * n : n;
  const std::int64_t rest = i < 0 ? period - 1 - (-1 - i) % period : i % period;
  return static_cast<std::uint32_t>(rest < n ? rest : period - 1 - rest);
}

}  // namespace meshlode::draw
