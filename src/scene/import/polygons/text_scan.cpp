// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/text_scan.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>
#include <system_error>

#include "base/utf8.h"

namespace meshlode::scene {

namespace {

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// What Microsoft's C library printed until 2015: 1.#INF00, -1.#IND, 1.#QNAN, 1.#SNAN.
std::optional<double> parse_old_special(std::string_view word) {
  const bool is_negative = word.starts_with('-');
  if (is_negative) word.remove_prefix(1);
  if (!word.starts_with("1.#")) return std::nullopt;
  word.remove_prefix(3);
  while (word.ends_with('0')) word.remove_suffix(1);
  if (is_word(word, "inf")) {
    return is_negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  }
  if (is_word(word, "ind") || is_word(word, "qnan") || is_word(word, "snan")) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::nullopt;
}

/// "+1" is a number, "+-1" is none.
std::string_view without_plus(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  return word;
}

}  // namespace

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
}

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

std::string_view unquoted(std::string_view text) {
  text = trimmed(text);
  return text.size() > 2 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2) : text;
}

std::string_view take_name(std::string_view& text) {
  std::string_view rest = text;
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  const std::size_t end = rest.starts_with('"') ? rest.find('"', 1) : std::string_view::npos;
  if (end == std::string_view::npos || end == 1) return take_word(text);
  text = rest.substr(end + 1);
  return rest.substr(1, end - 1);
}

std::string_view take_line(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  const std::string_view line = text.substr(0, end);
  if (end < text.size()) end += text.substr(end).starts_with("\r\n") ? 2 : 1;
  text.remove_prefix(end);
  return line;
}

std::string_view take_joined_line(std::string_view& text, std::string& joined, std::size_t& count) {
  const auto goes_on = [](std::string_view& line) {
    std::string_view rest = line;
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    if (rest.empty() || rest.back() != '\\') return false;
    line = rest.substr(0, rest.size() - 1);
    return true;
  };
  std::string_view line = take_line(text);
  std::string_view rest = line;
  const std::string_view keyword = take_word(rest);
  constexpr std::string_view kNamed[] = {"g", "o", "usemtl", "mtllib", "usemap", "maplib"};
  const bool takes_name = std::find(std::begin(kNamed), std::end(kNamed), keyword) != std::end(kNamed);
  const std::string_view whole = line;
  if (keyword.starts_with('#') || !goes_on(line)) return line;
  if (takes_name && !line.empty() && !is_blank(line.back())) return whole;
  joined.assign(line);
  while (!text.empty()) {
    ++count;
    std::string_view more = take_line(text);
    const bool is_open = goes_on(more);
    joined.append(" ").append(more);
    if (!is_open) break;
  }
  return joined;
}

std::string folded(std::string_view word) {
  std::string out(word);
  std::transform(out.begin(), out.end(), out.begin(), lower);
  return out;
}

bool is_word(std::string_view word, std::string_view lower_word) {
  return std::equal(word.begin(), word.end(), lower_word.begin(), lower_word.end(),
                    [](char a, char b) { return lower(a) == b; });
}

bool looks_like_text(std::string_view text) {
  const std::string_view head = text.substr(0, 1024);
  return std::none_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && !is_blank(c)) || byte == 0 || byte == 0x7F;
  });
}

std::optional<double> parse_number(std::string_view word) {
  word = without_plus(word);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return parse_old_special(word);
  if (error == std::errc::result_out_of_range) {
    // from_chars does not say which way; a negative exponent means too small.
    const bool is_small = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
    return is_small ? 0.0 : std::numeric_limits<double>::infinity();
  }
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
  word = without_plus(word);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::string shown(std::string_view name) {
  std::string out(name.substr(0, 64));
  std::replace_if(
      out.begin(), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return as_utf8(out);
}

std::string counted(std::uint64_t count, std::string_view noun, std::string_view plural) {
  const std::string text = std::to_string(count) + " ";
  if (count == 1) return text + std::string(noun);
  return text + (plural.empty() ? std::string(noun) + "s" : std::string(plural));
}

void Tally::add(std::string_view name, std::uint64_t count) {
  const auto found = counts_.find(name);
  if (found != counts_.end()) {
    found->second += count;
  } else {
    counts_.emplace(name, count);
  }
}

}  // namespace meshlode::scene
