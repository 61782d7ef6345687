// SPDX-License-Identifier: GPL-3.0-or-later
// Words, lines and numbers of a file that is counted. On purpose not the importer's: a mistake there must not be made
// here too.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace meshlode::scene::count {

constexpr std::string_view kBlanks(" \t\r\n\v\f\0", 7);

inline char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// \param lower_word in lower case
inline bool is_word(std::string_view word, std::string_view lower_word) {
  return std::equal(word.begin(), word.end(), lower_word.begin(), lower_word.end(),
                    [](char a, char b) { return lower(a) == b; });
}

inline std::string_view without_mark(std::string_view text) {
  return text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text;
}

/// Takes the next word off the front; empty at the end.
inline std::string_view take_word(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

/// Takes a line off the front, without its end: LF, CR LF or CR.
inline std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  text.remove_prefix(line.size());
  text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
  return line;
}

inline bool is_empty(std::string_view line) {
  return line.find_first_not_of(kBlanks) == std::string_view::npos;
}

/// A whole word as a number; nothing where it is none, or out of range.
template <class Number>
std::optional<Number> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

/// Whether three corners of a face are different.
class Corners {
 public:
  void add(std::int64_t corner) {
    if (count_ == 3 || std::find(seen_, seen_ + count_, corner) != seen_ + count_) return;
    seen_[count_++] = corner;
  }
  [[nodiscard]] bool are_three() const { return count_ == 3; }

 private:
  std::int64_t seen_[3] = {};
  int count_ = 0;
};

}  // namespace meshlode::scene::count
