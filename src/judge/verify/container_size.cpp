// SPDX-License-Identifier: GPL-3.0-or-later
// The heads of the two containers that glTF's extensions allow and stb_image does not read: KTX2 (KTX File Format 2.0,
// section 3) and WebP (RFC 9649, section 2).
#include <algorithm>
#include <array>

#include "judge/verify/texel_budget.h"

namespace meshlode::judge {

namespace {

using Size = std::optional<std::pair<std::uint32_t, std::uint32_t>>;

/// Bits `first` … `first + count - 1` of the bytes, the lowest bit of the first byte being bit 0. \pre they are there
std::uint32_t bits_at(std::span<const std::uint8_t> bytes, std::size_t first, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    value |= (static_cast<std::uint32_t>(bytes[(first + i) / 8]) >> (first + i) % 8 & 1U) << i;
  }
  return value;
}

template <std::size_t N>
bool has_at(std::span<const std::uint8_t> bytes, std::size_t at, const std::array<std::uint8_t, N>& what) {
  return bytes.size() >= at + N &&
         std::equal(what.begin(), what.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

Size ktx2_size(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kWidth = 8 * 20, kHeight = 8 * 24;
  if (bytes.size() < 28) return std::nullopt;
  return std::pair{bits_at(bytes, kWidth, 32), bits_at(bytes, kHeight, 32)};
}

/// Sizes of extended and lossless files are stored less one.
Size webp_size(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kData = 20;
  if (bytes.size() < kData + 10) return std::nullopt;
  const auto data = bytes.subspan(kData);
  if (has_at<4>(bytes, 12, {'V', 'P', '8', 'X'})) {
    return std::pair{1 + bits_at(data, 8 * 4, 24), 1 + bits_at(data, 8 * 7, 24)};
  }
  if (has_at<4>(bytes, 12, {'V', 'P', '8', 'L'}) && data[0] == 0x2F) {
    return std::pair{1 + bits_at(data, 8, 14), 1 + bits_at(data, 8 + 14, 14)};
  }
  const bool is_lossy = has_at<4>(bytes, 12, {'V', 'P', '8', ' '}) && has_at<3>(data, 3, {0x9D, 0x01, 0x2A});
  if (!is_lossy || (data[0] & 1U) != 0) return std::nullopt;  // only a key frame states a size
  return std::pair{bits_at(data, 8 * 6, 14), bits_at(data, 8 * 8, 14)};
}

}  // namespace

Size stated_container_size(std::span<const std::uint8_t> bytes) {
  Size size;
  if (has_at<12>(bytes, 0, {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, 0x0D, 0x0A, 0x1A, 0x0A})) {
    size = ktx2_size(bytes);
  } else if (has_at<4>(bytes, 0, {'R', 'I', 'F', 'F'}) && has_at<4>(bytes, 8, {'W', 'E', 'B', 'P'})) {
    size = webp_size(bytes);
  }
  return size && size->first > 0 && size->second > 0 ? size : std::nullopt;
}

}  // namespace meshlode::judge
