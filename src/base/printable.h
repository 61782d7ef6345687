// SPDX-License-Identifier: MIT
// Names that come from a file, and counts, on their way to a terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace meshlode {

/// Without control characters, and no longer than the limit in bytes; "(no name)" for nothing.
[[nodiscard]] inline std::string printable(std::string_view name, std::size_t limit = 60) {
  std::string out;
  for (const char c : name.substr(0, limit)) out += static_cast<unsigned char>(c) < 0x20 || c == 0x7F ? '?' : c;
  return out.empty() ? "(no name)" : out;
}

/// ", got 'WORD'", the end of a message about a word that is not what was expected.
[[nodiscard]] inline std::string got_text(std::string_view word) {
  return word.empty() ? std::string(", got nothing") : ", got '" + printable(word, 64) + "'";
}

/// 1234567 -> "1,234,567".
[[nodiscard]] inline std::string grouped_digits(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, 1, ',');
  return digits;
}

}  // namespace meshlode
