// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/page/text_forms.h"

#include <algorithm>
#include <cstddef>

#include "base/utf8.h"

namespace meshlode::app {

namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";

/// U+202A to U+202E, U+2066 to U+2069 turn the text that stands around them; U+FFFE and U+FFFF are no characters.
bool is_refused(std::string_view character) {
  if (character.size() == 1) {
    const auto byte = static_cast<unsigned char>(character[0]);
    return (byte < 0x20 && byte != '\t' && byte != '\n') || byte == 0x7F;
  }
  if (character.size() != 3) return false;
  const std::string_view head = character.substr(0, 2);
  const auto last = static_cast<unsigned char>(character[2]);
  if (head == "\xE2\x80") return last >= 0xAA && last <= 0xAE;
  if (head == "\xE2\x81") return last >= 0xA6 && last <= 0xA9;
  return head == "\xEF\xBF" && last >= 0xBE;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t n = utf8_length(text);
    const std::string_view character = text.substr(0, n == 0 ? 1 : n);
    text.remove_prefix(character.size());
    if (n == 0 || is_refused(character)) {
      out += kReplacement;
    } else if (character == "&") {
      out += "&amp;";
    } else if (character == "<") {
      out += "&lt;";
    } else if (character == ">") {
      out += "&gt;";
    } else if (character == "\"") {
      out += "&quot;";
    } else if (character == "'") {
      out += "&#39;";
    } else {
      out += character;
    }
  }
  return out;
}

std::string script_json(std::string_view json) {
  std::string out;
  for (const char c : json) out += c == '<' ? std::string("\\u003c") : std::string(1, c);
  return out;
}

std::string fill_holes(std::string_view frame, std::span<const PageHole> holes) {
  std::string out;
  for (std::string_view rest = frame; !rest.empty();) {
    const std::size_t mark = rest.find('@');
    out += rest.substr(0, mark);
    if (mark == std::string_view::npos) break;
    rest.remove_prefix(mark);
    const auto hole =
        std::find_if(holes.begin(), holes.end(), [&](const PageHole& h) { return rest.starts_with(h.first); });
    out += hole != holes.end() ? hole->second : "@";
    rest.remove_prefix(hole != holes.end() ? hole->first.size() : 1);
  }
  return out;
}

std::string encode_base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = bytes.size() - i < 3 ? bytes.size() - i : 3;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8U | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

}  // namespace meshlode::app
