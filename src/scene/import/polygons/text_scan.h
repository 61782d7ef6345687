// SPDX-License-Identifier: GPL-3.0-or-later
// Words, lines and numbers of hostile text; independent of the locale.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshlode::scene {

[[nodiscard]] inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// Takes the next word off the front; empty at the end.
std::string_view take_word(std::string_view& text);
/// Without blanks at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Takes a line off the front, without its end.
std::string_view take_line(std::string_view& text);
/// The same of a line that goes on where it ends with a backslash, in `joined` then; adds the lines to `count` but the
/// first.
std::string_view take_joined_line(std::string_view& text, std::string& joined, std::size_t& count);
/// A whole word as a number; "nan" and "inf" are numbers, "1x" is not. Too large: infinite; too small: zero.
[[nodiscard]] std::optional<double> parse_number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view word);

}  // namespace meshlode::scene
