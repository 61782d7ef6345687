// SPDX-License-Identifier: GPL-3.0-or-later
#include "draw/textures/image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string_view>

#include "base/try.h"
#include "draw/textures/image_readers.h"

namespace meshlode::draw {

Status check_image_size(std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0) return Error{ErrorCode::kInvalid, "image", "no texels"};
  if (width > kMaxTextureSide || height > kMaxTextureSide) {
    return Error{ErrorCode::kUnsupported, "image",
                 std::to_string(width) + " x " + std::to_string(height) + " texels, at most " +
                     std::to_string(kMaxTextureSide) + " a side are read"};
  }
  return Ok{};
}

namespace {

static_assert(std::endian::native == std::endian::little, "the libraries write a texel's bytes, red first");

Result<ImageHeader> read_any(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels) {
  constexpr std::array<std::uint8_t, 8> kPng{0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  constexpr std::array<std::uint8_t, 2> kJpeg{0xFF, 0xD8};
  const auto begins_with = [&](std::span<const std::uint8_t> first) {
    return bytes.size() >= first.size() && std::equal(first.begin(), first.end(), bytes.begin());
  };
  const auto has_at = [&](std::size_t at, std::string_view text) {
    return bytes.size() >= at + text.size() &&
           std::equal(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  };
  if (begins_with(kPng)) return read_png(bytes, texels);
  if (begins_with(kJpeg)) return read_jpeg(bytes, texels);
  if (has_at(0, "RIFF") && has_at(8, "WEBP")) return read_webp(bytes, texels);
  // What glTF's extensions carry beside them, by name.
  const char* kind = has_at(1, "KTX 20")    ? "KTX2 (Basis Universal) is not decoded"
                     : has_at(0, "DDS ")    ? "DDS is not decoded"
                     : has_at(4, "ftypavi") ? "AVIF is not decoded"
                                            : "neither PNG, JPEG nor WebP";
  return Error{ErrorCode::kUnsupported, "image", kind};
}

}  // namespace

Result<ImageHeader> read_image_header(std::span<const std::uint8_t> bytes) {
  return read_any(bytes, nullptr);
}

Result<DecodedImage> decode_image(std::span<const std::uint8_t> bytes, std::uint64_t capacity) {
  DecodedImage out;
  if (capacity > 0) {
    // Bytes that are no such image must not cost the room for one.
    TRY(read_image_header(bytes));
    out.texels.reserve(capacity);
  }
  TRY_LET(header, read_any(bytes, &out.texels));
  out.width = header->width;
  out.height = header->height;
  return out;
}

}  // namespace meshlode::draw
