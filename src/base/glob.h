// SPDX-License-Identifier: MIT
// Names by patterns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string_view>

namespace meshlode {

/// '*' is any number of characters, '?' is one, all others are themselves; the whole name.
[[nodiscard]] inline bool is_match(std::string_view glob, std::string_view name) {
  std::size_t g = 0, n = 0;
  std::optional<std::size_t> star;  // the last one met, and what it has taken
  std::size_t taken = 0;
  while (n < name.size()) {
    if (g < glob.size() && glob[g] == '*') {
      star = g++;
      taken = n;
    } else if (g < glob.size() && (glob[g] == '?' || glob[g] == name[n])) {
      ++g;
      ++n;
    } else if (star) {
      g = *star + 1;
      n = ++taken;
    } else {
      return false;
    }
  }
  while (g < glob.size() && glob[g] == '*') ++g;
  return g == glob.size();
}

/// The same for globs that are separated by commas: whether one of them is of this name. An empty one is of none.
[[nodiscard]] inline bool is_match_of_any(std::string_view globs, std::string_view name) {
  while (!globs.empty()) {
    const std::size_t comma = std::min(globs.find(','), globs.size());
    if (comma > 0 && is_match(globs.substr(0, comma), name)) return true;
    globs.remove_prefix(std::min(comma + 1, globs.size()));
  }
  return false;
}

}  // namespace meshlode
