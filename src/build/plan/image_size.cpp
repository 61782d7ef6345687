// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/plan/image_size.h"

#include <algorithm>
#include <array>

namespace meshlode::build {

namespace {

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

std::optional<ImageSize> checked(std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0) return std::nullopt;
  return ImageSize{width, height};
}

/// Signature, then chunk IHDR: length, name, width, height (PNG specification, 11.2.2).
std::optional<ImageSize> read_png(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 8> kSignature{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  constexpr std::array<std::uint8_t, 4> kHeader{'I', 'H', 'D', 'R'};
  if (bytes.size() < 24 || !std::equal(kSignature.begin(), kSignature.end(), bytes.begin())) return std::nullopt;
  if (!std::equal(kHeader.begin(), kHeader.end(), bytes.begin() + 12)) return std::nullopt;
  return checked(big_endian(bytes.subspan(16, 4)), big_endian(bytes.subspan(20, 4)));
}

/// Segments up to the first frame header, whichever coding it announces (ITU-T T.81, B.2).
std::optional<ImageSize> read_jpeg(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8) return std::nullopt;
  std::size_t at = 2;
  while (at + 4 <= bytes.size()) {
    if (bytes[at] != 0xFF) return std::nullopt;
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xFF) {  // fill bytes may stand before a marker
      ++at;
      continue;
    }
    const bool is_alone = marker == 0x01 || (marker >= 0xD0 && marker <= 0xD7);
    if (is_alone) {
      at += 2;
      continue;
    }
    const std::uint32_t length = big_endian(bytes.subspan(at + 2, 2));
    if (length < 2) return std::nullopt;
    // SOF0 … SOF15, without DHT, JPG and DAC, which share the row.
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      if (at + 9 > bytes.size()) return std::nullopt;
      return checked(big_endian(bytes.subspan(at + 7, 2)), big_endian(bytes.subspan(at + 5, 2)));
    }
    if (marker == 0xDA || marker == 0xD9) return std::nullopt;  // the picture begins, or it is over
    at += 2U + length;
  }
  return std::nullopt;
}

}  // namespace

std::optional<ImageSize> read_image_size(std::span<const std::uint8_t> bytes) {
  if (const auto size = read_png(bytes)) return size;
  return read_jpeg(bytes);
}

}  // namespace meshlode::build
