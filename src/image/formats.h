// SPDX-License-Identifier: GPL-3.0-or-later
// The two readers behind decode_image(): each library is seen by one file.
#pragma once

#include "image/image.h"

namespace meshlode::image {

[[nodiscard]] Result<DecodedImage> decode_png(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<DecodedImage> decode_jpeg(std::span<const std::uint8_t> bytes);

/// Errors: kUnsupported for a side of more than kMaxTextureSide, kInvalid for one of 0.
[[nodiscard]] Status check_image_size(std::uint64_t width, std::uint64_t height);

}  // namespace meshlode::image
