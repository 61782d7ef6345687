// SPDX-License-Identifier: MIT
// JSON as it lies: a value is a place in the text, and finding something in it is reading from there. Takes no memory
// and no stack, so that the text may be anything; what is not JSON as it should be is nowhere.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string_view>

namespace meshlode::run {

/// A JsonHandle of base/gltf_textures.h. Keys are compared as they are written, without unescaping.
class JsonText {
 public:
  JsonText() = default;                                            ///< nowhere
  explicit JsonText(std::string_view text) : text_(trim(text)) {}  ///< the value that `text` begins with
  [[nodiscard]] bool is_object() const { return starts_with('{'); }
  [[nodiscard]] JsonText find(std::string_view key) const {
    JsonText found;
    for_each([&](std::string_view name, const JsonText& value) {
      if (is_object() && name == key) found = value;  // of a key that is there twice the last, as parsers have it
    });
    return found;
  }
  /// Entries of an array.
  [[nodiscard]] std::size_t size() const {
    std::size_t count = 0;
    for_each([&](std::string_view, const JsonText&) { count += starts_with('[') ? 1U : 0U; });
    return count;
  }
  [[nodiscard]] JsonText item(std::size_t i) const {
    JsonText found;
    if (!starts_with('[')) return found;
    std::size_t at = 0;
    for_each([&](std::string_view, const JsonText& value) {
      if (at++ == i) found = value;
    });
    return found;
  }
  /// A whole number below 2^53 without sign and exponent; 3.0 counts as 3.
  [[nodiscard]] std::optional<std::uint64_t> index() const {
    std::uint64_t value = 0;
    std::size_t at = 0;
    for (; at < text_.size() && text_[at] >= '0' && text_[at] <= '9'; ++at) {
      value = 10 * value + static_cast<std::uint64_t>(text_[at] - '0');
      if (value >= std::uint64_t{1} << 53U) return std::nullopt;
    }
    if (at == 0) return std::nullopt;
    if (at + 1 < text_.size() && text_[at] == '.' && text_[at + 1] == '0') {
      for (++at; at < text_.size() && text_[at] == '0';) ++at;
    }
    return trim(text_.substr(at)).empty() ? std::optional(value) : std::nullopt;
  }
  /// Whole numbers alone: nobody here asks for others.
  [[nodiscard]] std::optional<double> number() const {
    const auto whole = index();
    return whole ? std::optional(static_cast<double>(*whole)) : std::nullopt;
  }
  [[nodiscard]] bool operator==(const JsonText& other) const { return text_.data() == other.text_.data(); }
  /// The members of an object or the entries of an array, as far as they can be read.
  template <class Visit>
  void for_each(const Visit& visit) const {
    const bool has_keys = is_object();
    if (!has_keys && !starts_with('[')) return;
    std::string_view rest = trim(text_.substr(1));
    while (!rest.empty() && rest[0] != '}' && rest[0] != ']') {
      std::string_view key;
      if (has_keys) {
        if (rest[0] != '"') return;
        const std::size_t end = end_of_string(rest);
        key = rest.substr(1, end - 2);
        rest = trim(rest.substr(end));
        if (rest.empty() || rest[0] != ':') return;
        rest = trim(rest.substr(1));
      }
      const std::size_t end = end_of_value(rest);
      if (end == 0) return;
      visit(key, JsonText(rest.substr(0, end)));
      rest = trim(rest.substr(end));
      if (rest.empty() || rest[0] != ',') return;
      rest = trim(rest.substr(1));
    }
  }

 private:
  [[nodiscard]] bool starts_with(char c) const { return !text_.empty() && text_[0] == c; }
  [[nodiscard]] static std::string_view trim(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first == std::string_view::npos ? std::string_view() : text.substr(first);
  }
  /// Behind its closing quote; the end of the text without one. \pre text starts with a quote
  [[nodiscard]] static std::size_t end_of_string(std::string_view text) {
    for (std::size_t i = 1; i < text.size(); ++i) {
      if (text[i] == '\\') {
        ++i;
      } else if (text[i] == '"') {
        return i + 1;
      }
    }
    return text.size();
  }
  /// Behind the value that the text starts with; 0 without one.
  [[nodiscard]] static std::size_t end_of_value(std::string_view text) {
    std::size_t depth = 0;
    for (std::size_t i = 0; i < text.size();) {
      const char c = text[i];
      if (c == '"') {
        i += end_of_string(text.substr(i));
        if (depth == 0) return i;
        continue;
      }
      if (c == '{' || c == '[') {
        ++depth;
      } else if (c == '}' || c == ']') {
        if (depth == 0) return i;  // of what holds the value
        if (--depth == 0) return i + 1;
      } else if (depth == 0 && c == ',') {
        return i;
      }
      ++i;
    }
    return depth == 0 ? text.size() : 0;
  }

  std::string_view text_;
};

}  // namespace meshlode::run
