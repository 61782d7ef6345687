// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a PLY behind its header, ascii or binary of either order.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "scene/import/polygons/ply_header.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

class PlyBody {
 public:
  PlyBody(const PlyHeader& header, std::string_view text);

  /// The next value; nothing at the end or where it is no number.
  std::optional<double> next(PlyType type) {
    if (is_ascii_) {
      const std::string_view word = take_word(text_);
      return word.empty() ? std::nullopt : parse_number(word);
    }
    const std::size_t size = size_of(type);
    if (text_.size() < size) return std::nullopt;
    std::array<char, 8> raw{};
    std::copy_n(text_.begin(), size, raw.begin());
    if (is_big_endian_) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    text_.remove_prefix(size);
    switch (type) {
      case PlyType::kInt8: return load<std::int8_t>(raw);
      case PlyType::kUint8: return load<std::uint8_t>(raw);
      case PlyType::kInt16: return load<std::int16_t>(raw);
      case PlyType::kUint16: return load<std::uint16_t>(raw);
      case PlyType::kInt32: return load<std::int32_t>(raw);
      case PlyType::kUint32: return load<std::uint32_t>(raw);
      case PlyType::kFloat: return static_cast<double>(load<float>(raw));
      default: return load<double>(raw);
    }
  }
  /// A list's length: a whole number of zero or more.
  std::optional<std::uint64_t> next_count(PlyType type);
  /// Skips a property's value or list.
  bool skip(const PlyProperty& property);
  /// Behind the last value of an element's row: where each row has a line of its own, what else is on it is skipped.
  void end_row();
  /// True where the rest of the file could hold that many elements at all: at least one byte a property.
  [[nodiscard]] bool is_justified(const PlyElement& element) const {
    return element.count == 0 ||
           (!element.properties.empty() && element.count <= text_.size() / element.properties.size() + 1);
  }
  [[nodiscard]] std::uint64_t surplus() const { return surplus_; }  ///< values that end_row() skipped
  [[nodiscard]] std::uint64_t rest() const { return is_ascii_ ? trimmed(text_).size() : text_.size(); }

 private:
  template <class T>
  static T load(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  bool is_ascii_, is_big_endian_, has_rows_ = false;
  std::string_view text_;
  std::uint64_t surplus_ = 0;
};

}  // namespace meshlode::scene
