// SPDX-License-Identifier: GPL-3.0-or-later
// An image of which no more is known than its size.
#pragma once

#include <cstdint>
#include <vector>

namespace meshlode::test {

/// A PNG's signature and header.
inline std::vector<std::uint8_t> png_of(std::uint32_t width, std::uint32_t height) {
  std::vector<std::uint8_t> bytes{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
  for (const std::uint32_t size : {width, height}) {
    for (std::uint32_t shift = 32; shift > 0; shift -= 8)
      bytes.push_back(static_cast<std::uint8_t>(size >> (shift - 8)));
  }
  for (const int b : {8, 6, 0, 0, 0, 0, 0, 0, 0}) bytes.push_back(static_cast<std::uint8_t>(b));
  return bytes;
}

}  // namespace meshlode::test
