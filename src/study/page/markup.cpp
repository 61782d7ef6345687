// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/page/markup.h"

#include <cassert>

#include "base/utf8.h"

namespace meshlode::study::page {

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

std::string escaped(std::string_view text) {
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

void Markup::start(std::string_view tag, std::initializer_list<Attribute> attributes) {
  out_ += '<';
  out_ += tag;
  for (const Attribute& attribute : attributes) {
    out_ += ' ';
    out_ += attribute.name;
    out_ += "=\"";
    out_ += escaped(attribute.value);
    out_ += '"';
  }
}

Markup& Markup::open(std::string_view tag, std::initializer_list<Attribute> attributes) {
  start(tag, attributes);
  out_ += '>';
  open_.emplace_back(tag);
  return *this;
}

Markup& Markup::close() {
  assert(!open_.empty());
  out_ += "</" + open_.back() + ">";
  open_.pop_back();
  return *this;
}

Markup& Markup::empty(std::string_view tag, std::initializer_list<Attribute> attributes) {
  start(tag, attributes);
  out_ += "/>";
  return *this;
}

Markup& Markup::text(std::string_view text) {
  out_ += escaped(text);
  return *this;
}

Markup& Markup::element(std::string_view tag, std::string_view text, std::initializer_list<Attribute> attributes) {
  open(tag, attributes);
  out_ += escaped(text);
  return close();
}

Markup& Markup::raw(std::string_view markup) {
  out_ += markup;
  return *this;
}

const std::string& Markup::str() const {
  assert(open_.empty());
  return out_;
}

}  // namespace meshlode::study::page
