// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/text_scan.h"

#include <charconv>
#include <limits>
#include <system_error>

namespace meshlode::scene {

std::string_view take_word(std::string_view& text) {
  std::size_t start = 0;
  while (start < text.size() && is_blank(text[start])) ++start;
  std::size_t end = start;
  while (end < text.size() && !is_blank(text[end])) ++end;
  const std::string_view word = text.substr(start, end - start);
  text.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::string_view take_joined_line(std::string_view& text, std::string& joined, std::size_t& count) {
  const std::string_view line = take_line(text);
  if (line.empty() || line.back() != '\\') return line;
  joined.assign(line.substr(0, line.size() - 1));
  while (!text.empty()) {
    ++count;
    std::string_view more = take_line(text);
    const bool goes_on = !more.empty() && more.back() == '\\';
    if (goes_on) more.remove_suffix(1);
    joined.append(" ").append(more);
    if (!goes_on) break;
  }
  return joined;
}

std::optional<double> parse_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say which way; a negative exponent means too small.
    const bool is_small = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
    return is_small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace meshlode::scene
