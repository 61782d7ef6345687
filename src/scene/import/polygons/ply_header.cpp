// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/ply_header.h"

#include <utility>
namespace meshlode::scene {

namespace {

std::optional<PlyType> parse_type(std::string_view word) {
  constexpr std::pair<std::string_view, PlyType> kTypes[] = {
      {"char", PlyType::kInt8},     {"int8", PlyType::kInt8},     {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},   {"short", PlyType::kInt16},   {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16}, {"uint16", PlyType::kUint16}, {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},   {"uint", PlyType::kUint32},   {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat},   {"float32", PlyType::kFloat}, {"double", PlyType::kDouble},
      {"float64", PlyType::kDouble}};
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  return std::nullopt;
}

Error invalid(std::string where, std::string detail) {
  return {ErrorCode::kInvalid, std::move(where), std::move(detail)};
}

/// A line of a header whose lines end with CR alone: what follows the last may begin with LF and belongs to the body.
std::string_view take_cr_line(std::string_view& text) {
  const std::size_t end = text.find('\r');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

Status add_format(std::string_view line, const std::string& where, PlyHeader& header) {
  const std::string_view format = take_word(line);
  header.is_ascii = format == "ascii";
  header.is_big_endian = format == "binary_big_endian";
  if (header.is_ascii || header.is_big_endian || format == "binary_little_endian") return Ok{};
  return invalid(where, "an unknown format");
}

Status add_element(std::string_view line, const std::string& where, PlyHeader& header) {
  PlyElement element;
  element.name = std::string(take_word(line));
  const auto count = parse_integer(take_word(line));
  if (!count || *count < 0 || *count > 0x7FFFFFFF) return invalid(where, "not a count of elements");
  element.count = static_cast<std::uint64_t>(*count);
  for (const PlyElement& other : header.elements) {
    if (other.name == element.name) return invalid(where, "an element of that name exists already");
  }
  header.elements.push_back(std::move(element));
  return Ok{};
}

Status add_property(std::string_view line, const std::string& where, PlyHeader& header) {
  if (header.elements.empty()) return invalid(where, "a property before any element");
  PlyProperty property;
  std::string_view word = take_word(line);
  if (word == "list") {
    property.list_count = parse_type(take_word(line));
    if (!property.list_count || is_float(*property.list_count)) {
      return invalid(where, "not a type for the length of a list");
    }
    word = take_word(line);
  }
  const auto type = parse_type(word);
  if (!type) return invalid(where, "an unknown type");
  property.type = *type;
  property.name = std::string(take_word(line));
  header.elements.back().properties.push_back(std::move(property));
  return Ok{};
}

}  // namespace

std::size_t size_of(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8: return 1;
    case PlyType::kInt16:
    case PlyType::kUint16: return 2;
    case PlyType::kDouble: return 8;
    default: return 4;
  }
}

bool is_float(PlyType type) {
  return type == PlyType::kFloat || type == PlyType::kDouble;
}

Result<PlyHeader> take_ply_header(std::string_view& text) {
  std::string_view first = text.substr(0, text.find_first_of("\r\n"));
  const bool is_cr = text.substr(first.size()).starts_with('\r') && !text.substr(first.size()).starts_with("\r\n");
  const auto take = [&] { return is_cr ? take_cr_line(text) : take_line(text); };
  first = take();
  if (trimmed(first) != "ply") return invalid("header", "it does not begin with ply");
  PlyHeader header;
  bool has_format = false;
  for (std::size_t line_number = 2;; ++line_number) {
    const std::string where = "header line " + std::to_string(line_number);
    if (text.empty() || line_number > 4096) return invalid(where, "end_header is missing");
    std::string_view line = take();
    const std::string_view keyword = take_word(line);
    Status status = Ok{};
    if (keyword == "end_header") break;
    if (keyword == "format") {
      status = add_format(line, where, header);
      has_format = true;
    } else if (keyword == "element") {
      status = add_element(line, where, header);
    } else if (keyword == "property") {
      status = add_property(line, where, header);
    } else if (keyword == "comment") {
      if (is_word(take_word(line), "texturefile") && !trimmed(line).empty())
        header.textures.emplace_back(unquoted(line));
    } else if (!keyword.empty()) {
      header.other.add(keyword.substr(0, 16));
    }
    if (!status) return status.error();
  }
  if (!has_format) return invalid("header", "the format line is missing");
  return header;
}

}  // namespace meshlode::scene
