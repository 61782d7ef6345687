// SPDX-License-Identifier: MIT
#include "base/image_size.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace meshlode {

namespace {

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

std::uint32_t little_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i > 0; --i) value = value << 8U | bytes[i - 1];
  return value;
}

bool begins_with(std::span<const std::uint8_t> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::equal(text.begin(), text.end(), bytes.begin(), [](char a, std::uint8_t b) {
           return static_cast<std::uint8_t>(a) == b;
         });
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

/// Identifier, then the header's words: vkFormat, typeSize, pixelWidth, pixelHeight (KTX File Format 2.0, section 3).
std::optional<ImageSize> read_ktx2(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kIdentifier = "\xABKTX 20\xBB\r\n\x1A\n";
  if (bytes.size() < 28 || !begins_with(bytes, kIdentifier)) return std::nullopt;
  return checked(little_endian(bytes.subspan(20, 4)), little_endian(bytes.subspan(24, 4)));
}

/// RIFF, then the first chunk, which is of one of three kinds (RFC 9649, section 2; the bitstreams: RFC 6386, 9.1, and
/// RFC 9649, 3.4).
std::optional<ImageSize> read_webp(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 30 || !begins_with(bytes, "RIFF") || !begins_with(bytes.subspan(8), "WEBP")) return std::nullopt;
  const auto name = bytes.subspan(12), data = bytes.subspan(20);
  if (begins_with(name, "VP8 ")) {
    const bool is_key_frame = (data[0] & 1U) == 0;
    if (!is_key_frame || !begins_with(data.subspan(3), "\x9D\x01\x2A")) return std::nullopt;
    constexpr std::uint32_t kSize = (1U << 14U) - 1;  // above it, how a player might enlarge the picture
    return checked(little_endian(data.subspan(6, 2)) & kSize, little_endian(data.subspan(8, 2)) & kSize);
  }
  if (begins_with(name, "VP8L")) {
    if (data[0] != 0x2F) return std::nullopt;
    const std::uint32_t bits = little_endian(data.subspan(1, 4));
    return checked((bits & 0x3FFFU) + 1, (bits >> 14U & 0x3FFFU) + 1);
  }
  if (!begins_with(name, "VP8X")) return std::nullopt;
  return checked(little_endian(data.subspan(4, 3)) + 1, little_endian(data.subspan(7, 3)) + 1);
}

}  // namespace

std::optional<ImageSize> read_image_size(std::span<const std::uint8_t> bytes) {
  if (const auto size = read_png(bytes)) return size;
  if (const auto size = read_jpeg(bytes)) return size;
  if (const auto size = read_ktx2(bytes)) return size;
  return read_webp(bytes);
}

std::uint64_t gpu_bytes_of(const ImageSize& size) {
  std::uint64_t bytes = 0, width = size.width, height = size.height;
  while (true) {
    bytes += 4 * width * height;
    if (width <= 1 && height <= 1) return bytes;
    width = std::max<std::uint64_t>(1, width / 2);
    height = std::max<std::uint64_t>(1, height / 2);
  }
}

std::optional<std::uint64_t> find_gpu_bytes(std::span<const std::uint8_t> image) {
  const auto size = read_image_size(image);
  if (!size || read_ktx2(image)) return std::nullopt;
  return gpu_bytes_of(*size);
}

}  // namespace meshlode
