// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/sniff.h"

#include <algorithm>
#include <initializer_list>

namespace meshlode::app {

bool nests_deeper_than(std::string_view text, std::size_t limit) {
  std::size_t depth = 0;
  bool is_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        is_string = false;
    } else if (c == '"') {
      is_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > limit) return true;
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return false;
}

std::string sniff_mime_type(std::span<const std::uint8_t> bytes) {
  const auto starts_with = [&](std::initializer_list<std::uint8_t> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts_with({0xFF, 0xD8, 0xFF})) return "image/jpeg";
  if (starts_with({0xAB, 'K', 'T', 'X', ' ', '2', '0'})) return "image/ktx2";
  if (starts_with({'R', 'I', 'F', 'F'})) return "image/webp";
  return "image/png";
}

}  // namespace meshlode::app
