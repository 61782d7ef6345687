// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <unistd.h>

namespace meshlode::cli {

namespace {

/// Written once, before any thread is started.
enum class ColorChoice : std::uint8_t { kAuto, kAlways, kNever };
ColorChoice color_choice = ColorChoice::kAuto;

bool has_color(Stream stream) {
  if (color_choice != ColorChoice::kAuto) return color_choice == ColorChoice::kAlways;
  const char* const no_color = std::getenv("NO_COLOR");  // https://no-color.org
  if (no_color != nullptr && *no_color != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  if (terminal == nullptr || std::string_view(terminal) == "dumb") return false;
  return is_terminal(stream);
}

constexpr const char* kCodes[] = {"\033[31m", "\033[32m", "\033[33m", "\033[1m", "\033[2m"};  ///< by Color

}  // namespace

bool is_terminal(Stream stream) {
  return ::isatty(stream == Stream::kOut ? STDOUT_FILENO : STDERR_FILENO) == 1;
}

void use_color(std::string_view choice) {
  color_choice = choice == "always"  ? ColorChoice::kAlways
                 : choice == "never" ? ColorChoice::kNever
                                     : ColorChoice::kAuto;
}

std::string colored(Stream stream, Color color, const std::string& text) {
  return has_color(stream) ? kCodes[static_cast<std::size_t>(color)] + text + "\033[0m" : text;
}

std::string with_colored_words(const std::string& text, std::span<const ColoredWord> words) {
  if (!has_color(Stream::kOut)) return text;
  std::string out;
  bool is_done = false;  // with this line
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string word = text.substr(at, end - at);
    const auto found = std::find_if(words.begin(), words.end(), [&](const ColoredWord& w) { return w.word == word; });
    const bool is_colored = !is_done && found != words.end();
    out += is_colored ? colored(Stream::kOut, found->color, word) : word;
    is_done = is_done || is_colored;
    if (end < text.size()) {
      out += text[end];
      is_done = is_done && text[end] != '\n';
    }
    at = end + 1;
  }
  return out;
}

bool is_unicode_terminal() {
  if (!is_terminal(Stream::kOut)) return false;
  // Asked of the environment: setlocale() would change how numbers are printed.
  for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    std::string letters;  // of "en_GB.UTF-8@euro", without the rest
    for (const char c : std::string(value)) {
      if (c == '-' || c == '_') continue;
      letters += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return letters.find(".utf8") != std::string::npos;
  }
  return false;
}

}  // namespace meshlode::cli
