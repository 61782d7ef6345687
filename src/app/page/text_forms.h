// SPDX-License-Identifier: GPL-3.0-or-later
// Texts and bytes as HTML and XML may hold them. Every page that the program writes escapes by these.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace meshlode::app {

/// Text for the inside of an element or a quoted attribute: no byte of it is markup. Bytes that are not UTF-8,
/// characters that XML forbids and those that turn the direction of what stands around them become U+FFFD.
[[nodiscard]] std::string escape_html(std::string_view text);

/// RFC 4648, section 4, with padding.
[[nodiscard]] std::string encode_base64(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::app
