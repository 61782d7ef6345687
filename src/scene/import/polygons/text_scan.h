// SPDX-License-Identifier: GPL-3.0-or-later
// The one text layer of PLY headers and bodies, OBJ, text STL and MTL: words, lines and numbers of hostile text,
// independent of the locale. A line ends with LF, CR LF or CR, and a file may mix them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace meshlode::scene {

/// Line ends and NUL too: some writers pad with it.
[[nodiscard]] inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' || c == '\0';
}

/// The bytes as text, without the UTF-8 byte order mark that editors put first.
[[nodiscard]] std::string_view text_of(std::span<const std::uint8_t> bytes);
/// Takes the next word off the front; empty at the end.
std::string_view take_word(std::string_view& text);
/// Without blanks at either end.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// The same without quotation marks around all of it: some writers put a file's name into them.
[[nodiscard]] std::string_view unquoted(std::string_view text);
/// Takes a word, or what stands between quotation marks, off the front.
std::string_view take_name(std::string_view& text);
/// Takes a line off the front, without its end.
std::string_view take_line(std::string_view& text);
/// The same of a line that goes on where it ends with a backslash, in `joined` then; adds the lines to `count` but the
/// first. A comment goes on nowhere; a statement of OBJ that takes a name only where a blank stands before the
/// backslash, since the name may be a folder's of Windows.
std::string_view take_joined_line(std::string_view& text, std::string& joined, std::size_t& count);
/// ASCII letters in lower case.
[[nodiscard]] std::string folded(std::string_view word);
/// \param lower in lower case
[[nodiscard]] bool is_word(std::string_view word, std::string_view lower);
/// The first bytes of `text` have no control character that text does not have.
[[nodiscard]] bool looks_like_text(std::string_view text);
/// A whole word as a number; "nan", "inf" and what C libraries print for them ("-1.#IND", "1.#INF") are numbers, "1x"
/// is not. Too large: infinite; too small: zero.
[[nodiscard]] std::optional<double> parse_number(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view word);
/// A name of the file's for a terminal: short, with '?' for control characters.
[[nodiscard]] std::string shown(std::string_view name);
/// "1 face", "2 faces"; of other nouns the plural too.
[[nodiscard]] std::string counted(std::uint64_t count, std::string_view noun, std::string_view plural = {});

/// Counts what a reader passes over, by name, so that each is said once.
class Tally {
 public:
  void add(std::string_view name, std::uint64_t count = 1);
  [[nodiscard]] std::size_t size() const { return counts_.size(); }
  [[nodiscard]] const std::map<std::string, std::uint64_t, std::less<>>& counts() const { return counts_; }

 private:
  std::map<std::string, std::uint64_t, std::less<>> counts_;
};

}  // namespace meshlode::scene
