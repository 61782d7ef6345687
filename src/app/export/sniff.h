// SPDX-License-Identifier: GPL-3.0-or-later
// What can be told of a text or an image by a look at its bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace meshlode::app {

/// Whether JSON text nests deeper than `limit` brackets; strings are skipped. Safe on any text.
[[nodiscard]] bool nests_deeper_than(std::string_view text, std::size_t limit);

/// glTF wants a type for an image in a buffer; a source file with an unknown extension leaves it to the bytes.
[[nodiscard]] std::string sniff_mime_type(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::app
