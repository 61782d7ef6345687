// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/count/ply_faces.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "scene/count/words.h"

namespace meshlode::scene::count {

namespace {

/// u, i or f with a size in bytes.
struct Type {
  char kind = 0;
  std::size_t size = 0;
};

struct Property {
  Type type, length;  ///< a length of size 0: no list
  bool is_corners = false;
};

struct Element {
  std::string_view name;
  std::uint64_t rows = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string_view format;
  std::vector<Element> elements;
};

Type type_of(std::string_view word) {
  constexpr std::pair<std::string_view, Type> kTypes[] = {
      {"char", {'i', 1}},  {"int8", {'i', 1}},   {"uchar", {'u', 1}},   {"uint8", {'u', 1}},
      {"short", {'i', 2}}, {"int16", {'i', 2}},  {"ushort", {'u', 2}},  {"uint16", {'u', 2}},
      {"int", {'i', 4}},   {"int32", {'i', 4}},  {"uint", {'u', 4}},    {"uint32", {'u', 4}},
      {"float", {'f', 4}}, {"double", {'f', 8}}, {"float32", {'f', 4}}, {"float64", {'f', 8}}};
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  return {};
}

bool add_property(std::string_view line, Element& element) {
  Property property;
  std::string_view word = take_word(line);
  const bool is_list = word == "list";
  if (is_list) {
    property.length = type_of(take_word(line));
    word = take_word(line);
  }
  property.type = type_of(word);
  const std::string_view name = take_word(line);
  const auto has_corners = [](const Property& other) { return other.is_corners; };
  property.is_corners = is_list && (name == "vertex_indices" || name == "vertex_index") &&
                        std::none_of(element.properties.begin(), element.properties.end(), has_corners);
  element.properties.push_back(property);
  return property.type.size != 0 && (!is_list || property.length.size != 0);
}

/// Takes the header off the front. Where its first line ends with CR alone every line does: an LF behind the last one
/// belongs to the body.
std::optional<Header> take_header(std::string_view& text) {
  constexpr std::uint64_t kMaxRows = 0x7FFFFFFF;
  const std::size_t end = text.find_first_of("\r\n");
  const bool is_cr = end != std::string_view::npos && text[end] == '\r' && !text.substr(end).starts_with("\r\n");
  Header header;
  while (!text.empty()) {
    std::string_view line = is_cr ? text.substr(0, text.find('\r')) : take_line(text);
    if (is_cr) text.remove_prefix(std::min(line.size() + 1, text.size()));
    const std::string_view keyword = take_word(line);
    if (keyword == "end_header") return header;
    if (keyword == "format") header.format = take_word(line);
    if (keyword == "element") {
      Element element;
      element.name = take_word(line);
      element.rows = number_of<std::uint64_t>(take_word(line)).value_or(kMaxRows + 1);
      if (element.rows > kMaxRows) return std::nullopt;
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty() || !add_property(line, header.elements.back())) return std::nullopt;
    }
  }
  return std::nullopt;
}

class Body {
 public:
  Body(const Header& header, std::string_view text)
      : text_(text), is_ascii_(header.format == "ascii"), is_big_endian_(header.format == "binary_big_endian") {
    std::uint64_t rows = 0, lines = 0;
    for (const Element& element : header.elements) rows += element.rows;
    for (; is_ascii_ && !text.empty() && lines <= rows;) lines += is_empty(take_line(text)) ? 0U : 1U;
    has_rows_ = is_ascii_ && lines == rows;
  }

  /// False where the body ends, or has no number.
  bool take_row(const Element& element, Corners& corners) {
    for (const Property& property : element.properties) {
      double count = 1.0;
      if (property.length.size != 0) {
        const auto length = next(property.length);
        if (!length) return false;
        count = *length;
      }
      for (double i = 0.0; i < count; i += 1.0) {
        const auto value = next(property.type);
        if (!value) return false;
        if (property.is_corners && *value >= 0.0 && *value < 4294967296.0) {
          corners.add(static_cast<std::int64_t>(*value));
        }
      }
    }
    if (has_rows_) take_line(text_);  // whatever else is on the row's line
    return true;
  }

 private:
  std::optional<double> next(const Type& type) {
    if (is_ascii_) return number_of<double>(take_word(text_));
    if (text_.size() < type.size) return std::nullopt;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.size; ++i) {
      const std::size_t at = is_big_endian_ ? i : type.size - 1 - i;
      bits = bits << 8U | static_cast<std::uint8_t>(text_[at]);
    }
    text_.remove_prefix(type.size);
    if (type.kind == 'u') return static_cast<double>(bits);
    if (type.kind == 'i')
      return static_cast<double>(static_cast<std::int64_t>(bits << (64 - 8 * type.size)) >> (64 - 8 * type.size));
    if (type.size == 4) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
    return std::bit_cast<double>(bits);
  }

  std::string_view text_;
  bool is_ascii_, is_big_endian_, has_rows_ = false;
};

}  // namespace

std::uint64_t count_ply_faces(std::string_view text) {
  const auto header = take_header(text);
  if (!header) return 0;
  Body body(*header, text);
  std::uint64_t faces = 0;
  for (const Element& element : header->elements) {
    if (element.properties.empty() && element.rows > 0) return faces;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      Corners corners;
      if (!body.take_row(element, corners)) return faces;
      faces += element.name == "face" && corners.are_three() ? 1U : 0U;
    }
  }
  return faces;
}

}  // namespace meshlode::scene::count
