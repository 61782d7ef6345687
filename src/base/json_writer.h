// SPDX-License-Identifier: MIT
// Writes one JSON document, key by key, two spaces of indentation. No library behind it: every verb may include it.
#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshlode {

/// Usage: w.begin_object(); w.field("meshes", 3u); w.key("items"); w.begin_array(); w.value("a"); w.end_array();
/// w.end_object(); w.text(). Strings are escaped, bytes that are not UTF-8 become U+FFFD; numbers that are not finite
/// become null, and so do the floats that mean infinity in the format.
class JsonWriter {
 public:
  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_array() { open('['); }
  void end_array() { close(']'); }
  void key(std::string_view name);

  void value(std::string_view text);
  void value(const char* text) { value(std::string_view(text)); }
  void value(const std::string& text) { value(std::string_view(text)); }
  void value(double number);
  void value(float number);  ///< the shortest decimal that reads back as the same float
  template <std::same_as<bool> T>
  void value(T truth) {
    literal(truth ? "true" : "false");
  }
  template <std::integral T>
  requires(!std::same_as<T, bool>) void value(T number) { literal(std::to_string(number)); }
  void null() { literal("null"); }
  void raw(std::string_view json) { literal(json); }  ///< \pre valid JSON

  template <class T>
  void field(std::string_view name, const T& v) {
    key(name);
    value(v);
  }

  /// A list of values.
  template <class Range>
  void array_field(std::string_view name, const Range& values) {
    key(name);
    begin_array();
    for (const auto& v : values) value(v);
    end_array();
  }
  /// null where there is none.
  template <class T>
  void optional_field(std::string_view name, const std::optional<T>& v) {
    key(name);
    if (v) {
      value(*v);
    } else {
      null();
    }
  }
  /// null where it is empty.
  void text_or_null_field(std::string_view name, std::string_view text) {
    optional_field(name, text.empty() ? std::nullopt : std::optional(text));
  }

  /// The document and a line break. \pre every begin has its end
  [[nodiscard]] std::string text() const { return out_ + "\n"; }

 private:
  void open(char bracket);
  void close(char bracket);
  void literal(std::string_view json);
  void separate();

  std::string out_;
  int depth_ = 0;
  bool is_first_ = true;
  bool after_key_ = false;
};

}  // namespace meshlode
