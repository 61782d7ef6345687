// SPDX-License-Identifier: MIT
// Width and height of a PNG, JPEG, KTX2 or WebP, from its header alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace meshlode {

struct ImageSize {
  std::uint32_t width = 0, height = 0;  ///< texels, at least 1
};

/// Nothing where the bytes are none of them, or end too early. Safe on any bytes.
[[nodiscard]] std::optional<ImageSize> read_image_size(std::span<const std::uint8_t> bytes);

/// What a GPU holds of an image that it cannot sample as it is stored: RGBA with 8 bits a channel, and all mip levels.
[[nodiscard]] std::uint64_t gpu_bytes_of(const ImageSize& size);
/// Of a PNG, JPEG or WebP. Nothing for others: KTX2 stays compressed, or the size is not known.
[[nodiscard]] std::optional<std::uint64_t> find_gpu_bytes(std::span<const std::uint8_t> image);

}  // namespace meshlode
