// SPDX-License-Identifier: MIT
// "Did you mean": of the names that are known, the one that a misspelt word is nearest to.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
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

/// The nearest name where it is near enough to have been meant: at most two letters away, and not all letters of a
/// short word are others. Nothing else.
[[nodiscard]] inline std::optional<std::string> find_near_name(std::string_view word,
                                                               std::span<const std::string> known) {
  constexpr std::size_t kMostEdits = 2;
  if (known.empty()) return std::nullopt;
  std::string name = nearest_name(word, known);
  const std::size_t edits = edit_distance(word.substr(0, 64), name);
  if (edits > kMostEdits || edits >= std::max(word.size(), name.size())) return std::nullopt;
  return name;
}

/// "; the nearest is NAME", or nothing where no name is near.
[[nodiscard]] inline std::string nearest_hint(std::string_view word, std::span<const std::string> known) {
  const auto name = find_near_name(word, known);
  return name ? "; the nearest is " + *name : std::string();
}

/// "none, lz4 or zstd".
[[nodiscard]] inline std::string list_of_choices(std::span<const std::string> names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  }
  return text;
}

/// The same; where no name is near all of them: "; choose none, lz4 or zstd".
[[nodiscard]] inline std::string nearest_or_all(std::string_view word, std::span<const std::string> known) {
  const std::string hint = nearest_hint(word, known);
  return hint.empty() ? "; choose " + list_of_choices(known) : hint;
}

/// What is wrong with a word that is none of the choices, with the nearest of them.
[[nodiscard]] inline std::string unknown_choice(std::string_view word, std::span<const std::string> choices) {
  return "unknown value '" + std::string(word.substr(0, 64)) + "'; choose " + list_of_choices(choices) +
         nearest_hint(word, choices);
}

}  // namespace meshlode
