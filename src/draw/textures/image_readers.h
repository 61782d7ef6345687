// SPDX-License-Identifier: GPL-3.0-or-later
// The readers behind decode_image(): each library is seen by one file.
#pragma once

#include "draw/textures/image.h"

namespace meshlode::draw {

/// The head alone where `texels` is null, else all texels too: those of `texels` are replaced, its capacity is kept.
[[nodiscard]] Result<ImageHeader> read_png(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels);
[[nodiscard]] Result<ImageHeader> read_jpeg(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels);
[[nodiscard]] Result<ImageHeader> read_webp(std::span<const std::uint8_t> bytes, std::vector<std::uint32_t>* texels);

/// Errors: kUnsupported for a side of more than kMaxTextureSide, kInvalid for one of 0.
[[nodiscard]] Status check_image_size(std::uint64_t width, std::uint64_t height);

}  // namespace meshlode::draw
