// SPDX-License-Identifier: GPL-3.0-or-later
// A JSON document as a tree of plain values, read from hostile text. nlohmann-json stays behind json.cpp. A value takes
// 16 bytes, and what it holds one block of memory: a tree takes at most 12 bytes per byte of text, and 16 where values
// are nested in one another and hold nothing else (tests/scene/import/out_of_memory_test.cpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <meshlode/result.h>

#include "scene/import/json_list.h"

namespace meshlode::scene {

struct JsonMember;

/// Null. Not trivially copyable: of a variant whose alternatives all move without throwing libstdc++ 12 believes that
/// it always has a value, and destroys one that is not there where making a copy runs out of memory. This one it
/// believes less of.
struct JsonNull {
  JsonNull() = default;
  JsonNull(const JsonNull&) noexcept {}
  JsonNull& operator=(const JsonNull&) noexcept { return *this; }
};

/// One JSON value. Objects keep the order of their members, so that what is carried through comes out as it went in.
struct Json {
  using Text = JsonList<char>;
  using Array = JsonList<Json>;
  using Object = JsonList<JsonMember>;
  std::variant<JsonNull, bool, std::int64_t, std::uint64_t, double, Text, Array, Object> value;

  [[nodiscard]] bool is_object() const { return std::holds_alternative<Object>(value); }
  [[nodiscard]] bool is_array() const { return std::holds_alternative<Array>(value); }
  [[nodiscard]] bool is_string() const { return std::holds_alternative<Text>(value); }
  [[nodiscard]] bool is_bool() const { return std::holds_alternative<bool>(value); }
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] const Array* array() const { return std::get_if<Array>(&value); }
  [[nodiscard]] const Object* object() const { return std::get_if<Object>(&value); }
  [[nodiscard]] std::optional<std::string_view> string() const {
    const auto* text = std::get_if<Text>(&value);
    return text != nullptr ? std::optional(std::string_view(text->data(), text->size())) : std::nullopt;
  }

  /// The member of an object, or nullptr where there is none or this is no object.
  [[nodiscard]] const Json* find(std::string_view key) const;
  [[nodiscard]] Json* find(std::string_view key);
  /// The member's value where it is an array or an object of at least one element, else an empty array.
  [[nodiscard]] const Array& items(std::string_view key) const;
  /// Any number as a double.
  [[nodiscard]] std::optional<double> number() const;
  /// A number that is a whole one of at most 53 bits and not negative; 3.0 counts as 3.
  [[nodiscard]] std::optional<std::uint64_t> index() const;

  /// Adds or replaces a member. \pre is_object()
  void set(std::string_view key, Json member);
  /// Removes a member where there is one.
  void erase(std::string_view key);
  /// Removes all of these at once. \pre `keys` is ascending
  void erase_all(const std::vector<std::string>& keys);

  [[nodiscard]] static Json make_object();
  [[nodiscard]] static Json make_array();
  [[nodiscard]] static Json make_index(std::uint64_t index);
  [[nodiscard]] static Json make_string(std::string_view text);
  [[nodiscard]] static Json make_number(double number);
  [[nodiscard]] static Json make_bool(bool flag);
};

struct JsonMember {
  std::string key;
  Json value;
};
static_assert(sizeof(Json) == 16);

/// Parses UTF-8 JSON of at most kMaxJsonDepth nested values. Duplicate keys are refused: readers disagree on them.
/// Errors: kInvalid with the byte at which the text went wrong; `where` is left to the caller.
[[nodiscard]] Result<Json> parse_json(std::string_view text);
constexpr std::size_t kMaxJsonDepth = 128;

/// The shortest text that reads back as the same tree.
[[nodiscard]] std::string dump_json(const Json& json);

}  // namespace meshlode::scene
