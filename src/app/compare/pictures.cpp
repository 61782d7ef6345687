// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/pictures.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace meshlode::app {

PictureDifference compare_pictures(std::span<const std::uint8_t> before, std::span<const std::uint8_t> after) {
  assert(before.size() == after.size());
  PictureDifference difference;
  difference.pixels = before.size() / 4;
  std::uint64_t squares = 0;  // at most 2^28 pixels, 3 · 255² each: below 2^46
  for (std::size_t pixel = 0; pixel < before.size() / 4; ++pixel) {
    std::uint32_t largest = 0;
    for (std::size_t i = 4 * pixel; i < 4 * pixel + 3; ++i) {
      const auto d = static_cast<std::uint32_t>(std::abs(int{before[i]} - int{after[i]}));
      largest = std::max(largest, d);
      squares += std::uint64_t{d} * d;
    }
    difference.differing_pixels += largest > 0 ? 1U : 0U;
    difference.max_difference = std::max(difference.max_difference, largest);
  }
  if (squares > 0) {
    const double mean = static_cast<double>(squares) / (3.0 * static_cast<double>(difference.pixels));
    difference.psnr = 10.0 * std::log10(255.0 * 255.0 / mean);
  }
  return difference;
}

}  // namespace meshlode::app
