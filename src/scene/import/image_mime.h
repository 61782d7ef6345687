// SPDX-License-Identifier: GPL-3.0-or-later
// What kind of image bytes are, by how they begin.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace meshlode::scene {

/// PNG, JPEG, KTX2, WebP and DDS; empty for anything else.
[[nodiscard]] std::string_view sniff_image_mime(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::scene
