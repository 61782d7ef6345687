// SPDX-License-Identifier: MIT
// Text that claims to be UTF-8.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace meshlode {

/// Bytes of the UTF-8 sequence at the start of `s`, 0 where it is not one (RFC 3629: no surrogates, no overlong forms).
/// \pre `s` is not empty
[[nodiscard]] inline std::size_t utf8_length(std::string_view s) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(s[i]); };
  const unsigned char b = byte(0);
  const std::size_t n = b < 0x80                ? 1
                        : b >= 0xC2 && b < 0xE0 ? 2
                        : b >= 0xE0 && b < 0xF0 ? 3
                        : b >= 0xF0 && b < 0xF5 ? 4
                                                : 0;
  if (n == 0 || n > s.size()) return 0;
  for (std::size_t i = 1; i < n; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  if ((b == 0xE0 && byte(1) < 0xA0) || (b == 0xED && byte(1) >= 0xA0) || (b == 0xF0 && byte(1) < 0x90) ||
      (b == 0xF4 && byte(1) >= 0x90)) {
    return 0;
  }
  return n;
}

/// Each byte that is not UTF-8 becomes U+FFFD.
[[nodiscard]] inline std::string as_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    out += n == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(0, n);
    text.remove_prefix(n == 0 ? 1 : n);
  }
  return out;
}

}  // namespace meshlode
