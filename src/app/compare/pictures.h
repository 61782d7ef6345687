// SPDX-License-Identifier: GPL-3.0-or-later
// How far two pictures of one size are apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace meshlode::app {

struct PictureDifference {
  std::uint64_t pixels = 0;
  std::uint64_t differing_pixels = 0;  ///< in any of red, green and blue
  std::uint32_t max_difference = 0;    ///< of one channel, 0 to 255
  /// 10 log10(255² / MSE) dB, MSE the mean of the squared differences over the three channels of all pixels. Nothing
  /// for equal pictures: it is infinite.
  std::optional<double> psnr;

  [[nodiscard]] double differing_share() const {
    return pixels == 0 ? 0.0 : static_cast<double>(differing_pixels) / static_cast<double>(pixels);
  }
};

/// 4 bytes a pixel, the fourth of which is not looked at. \pre both have the same size
[[nodiscard]] PictureDifference compare_pictures(std::span<const std::uint8_t> before,
                                                 std::span<const std::uint8_t> after);

}  // namespace meshlode::app
