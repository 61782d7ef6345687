// SPDX-License-Identifier: MIT
// "Did you mean": of the names that are known, the one that a misspelt word is nearest to.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace meshlode {

/// Letters to insert, remove or replace (Levenshtein 1966); upper and lower case are alike, and so are '-' and '_'.
/// O(|a| |b|).
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto fold = [](char c) {
    if (c == '_') return '-';
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (fold(a[i]) == fold(b[j]) ? 0U : 1U);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

/// The first of the nearest. Words are hostile: of a long one the first 64 bytes count. \pre not empty
[[nodiscard]] inline std::string nearest_name(std::string_view word, std::span<const std::string> known) {
  const auto distance = [&](const std::string& name) { return edit_distance(word.substr(0, 64), name); };
  return *std::min_element(known.begin(), known.end(),
                           [&](const std::string& a, const std::string& b) { return distance(a) < distance(b); });
}

}  // namespace meshlode
