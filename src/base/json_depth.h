// SPDX-License-Identifier: MIT
// How deep a JSON text nests, before a parser or a writer that recurses sees it.
#pragma once

#include <cstddef>
#include <string_view>

namespace meshlode {

/// Whether no array or object lies below more than `most_levels` others. The text need not be valid JSON.
[[nodiscard]] inline bool is_nested_within(std::string_view text, int most_levels) {
  int depth = 0;
  bool is_in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        is_in_string = false;
      }
    } else if (c == '"') {
      is_in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > most_levels) return false;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return true;
}

}  // namespace meshlode
