// SPDX-License-Identifier: GPL-3.0-or-later
// Texts and bytes as HTML and XML may hold them. Every page that the program writes escapes by these.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace meshlode::app {

/// Text for the inside of an element or a quoted attribute: no byte of it is markup. Bytes that are not UTF-8,
/// characters that XML forbids and those that turn the direction of what stands around them become U+FFFD.
[[nodiscard]] std::string escape_html(std::string_view text);

/// JSON for the inside of a script element, which it cannot end.
[[nodiscard]] std::string script_json(std::string_view json);

/// A mark as "@NAME@", and what is put there.
using PageHole = std::pair<std::string_view, std::string>;
/// The frame from left to right, each hole once: what is filled in is not looked at again.
[[nodiscard]] std::string fill_holes(std::string_view frame, std::span<const PageHole> holes);

/// RFC 4648, section 4, with padding.
[[nodiscard]] std::string encode_base64(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::app
