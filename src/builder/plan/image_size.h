// SPDX-License-Identifier: GPL-3.0-or-later
// Width and height of a PNG, JPEG, KTX2 or WebP, from its header alone.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace meshlode::builder {

struct ImageSize {
  std::uint32_t width = 0, height = 0;  ///< texels, at least 1
};

/// Nothing where the bytes are none of them, or end too early. Safe on any bytes.
[[nodiscard]] std::optional<ImageSize> read_image_size(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::builder
