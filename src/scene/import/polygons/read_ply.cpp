// SPDX-License-Identifier: GPL-3.0-or-later
// PLY (Turk 1994), ascii and both binary orders: every element is walked, vertices and faces are kept.
#include <algorithm>
#include <cstring>
#include <optional>

#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat;
  std::optional<PlyType> list_count;  ///< the type of the length, for lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

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

Error invalid(std::string where, std::string detail) {
  return {ErrorCode::kInvalid, std::move(where), std::move(detail)};
}

/// What a vertex may have.
enum Column : std::size_t { kX, kY, kZ, kNx, kNy, kNz, kU, kV, kRed, kGreen, kBlue, kAlpha, kColumnCount };

std::optional<Column> column_of(std::string_view name) {
  constexpr std::pair<std::string_view, Column> kNames[] = {{"x", kX},
                                                            {"y", kY},
                                                            {"z", kZ},
                                                            {"nx", kNx},
                                                            {"ny", kNy},
                                                            {"nz", kNz},
                                                            {"u", kU},
                                                            {"s", kU},
                                                            {"v", kV},
                                                            {"t", kV},
                                                            {"texture_u", kU},
                                                            {"texture_v", kV},
                                                            {"red", kRed},
                                                            {"green", kGreen},
                                                            {"blue", kBlue},
                                                            {"alpha", kAlpha},
                                                            {"diffuse_red", kRed},
                                                            {"diffuse_green", kGreen},
                                                            {"diffuse_blue", kBlue}};
  for (const auto& [known, column] : kNames) {
    if (known == name) return column;
  }
  return std::nullopt;
}

class PlyReader {
 public:
  PlyReader(std::span<const std::uint8_t> bytes, const ImportOptions& options)
      : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()), options_(options) {}

  Result<PolygonFile> run() {
    if (auto status = read_header(); !status) return status.error();
    for (const PlyElement& element : elements_) {
      Status status = Ok{};
      if (element.name == "vertex") {
        status = read_vertices(element);
      } else if (element.name == "face") {
        status = read_faces(element);
      } else {
        status = skip_element(element);
      }
      if (!status) return status.error();
    }
    if (small_faces_ != 0) {
      out_.left_out.push_back({std::to_string(small_faces_) + " faces", "they have fewer than three corners"});
    }
    return std::move(out_);
  }

 private:
  Status read_header();
  Status read_vertices(const PlyElement& element);
  Status read_faces(const PlyElement& element);
  Status skip_element(const PlyElement& element);
  void keep_vertex(const std::array<double, kColumnCount>& value);
  /// The next value of the body; nothing at its end or where it is no number.
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
  template <class T>
  static T load(const std::array<char, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }
  /// A list's length, or a vertex index: a whole number of zero or more.
  std::optional<std::uint64_t> next_index(PlyType type) {
    const auto value = next(type);
    if (!value || !(*value >= 0.0) || *value > 4294967295.0) return std::nullopt;
    const auto index = static_cast<std::uint64_t>(*value);
    return static_cast<double>(index) == *value ? std::optional(index) : std::nullopt;
  }
  /// Skips a property's value or list.
  bool skip(const PlyProperty& property) {
    if (!property.list_count) return next(property.type).has_value();
    const auto count = next_index(*property.list_count);
    for (std::uint64_t i = 0; count && i < *count; ++i) {
      if (!next(property.type)) return false;
    }
    return count.has_value();
  }
  /// True where the rest of the file could hold that many elements at all: at least one byte a property.
  [[nodiscard]] bool is_justified(const PlyElement& element) const {
    return element.count == 0 ||
           (!element.properties.empty() && element.count <= text_.size() / element.properties.size() + 1);
  }

  std::string_view text_;
  const ImportOptions& options_;
  bool is_ascii_ = true, is_big_endian_ = false;
  std::vector<PlyElement> elements_;
  std::array<bool, kColumnCount> has_{};
  std::uint64_t small_faces_ = 0;
  PolygonFile out_;
};

Status PlyReader::read_header() {
  if (take_line(text_) != "ply") return invalid("header", "it does not begin with ply");
  bool has_format = false;
  for (std::size_t line_number = 2;; ++line_number) {
    const std::string where = "header line " + std::to_string(line_number);
    if (text_.empty() || line_number > 4096) return invalid(where, "end_header is missing");
    std::string_view line = take_line(text_);
    const std::string_view keyword = take_word(line);
    if (keyword == "end_header") break;
    if (keyword == "format") {
      const std::string_view format = take_word(line);
      is_ascii_ = format == "ascii";
      is_big_endian_ = format == "binary_big_endian";
      if (!is_ascii_ && !is_big_endian_ && format != "binary_little_endian") return invalid(where, "an unknown format");
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = std::string(take_word(line));
      const auto count = parse_integer(take_word(line));
      if (!count || *count < 0 || *count > 0x7FFFFFFF) return invalid(where, "not a count of elements");
      element.count = static_cast<std::uint64_t>(*count);
      for (const PlyElement& other : elements_) {
        if (other.name == element.name) return invalid(where, "an element of that name exists already");
      }
      elements_.push_back(std::move(element));
    } else if (keyword == "property") {
      if (elements_.empty()) return invalid(where, "a property before any element");
      PlyProperty property;
      std::string_view word = take_word(line);
      if (word == "list") {
        property.list_count = parse_type(take_word(line));
        if (!property.list_count || size_of(*property.list_count) == 8 || *property.list_count == PlyType::kFloat) {
          return invalid(where, "not a type for the length of a list");
        }
        word = take_word(line);
      }
      const auto type = parse_type(word);
      if (!type) return invalid(where, "an unknown type");
      property.type = *type;
      property.name = std::string(take_word(line));
      elements_.back().properties.push_back(std::move(property));
    }  // comment, obj_info and unknown keywords say nothing about the body
  }
  return has_format ? Status(Ok{}) : Status(invalid("header", "the format line is missing"));
}

Status PlyReader::read_vertices(const PlyElement& element) {
  if (!is_justified(element)) return invalid("element vertex", "more vertices than the file has bytes for");
  std::vector<std::optional<Column>> columns;
  std::array<double, kColumnCount> scale{};
  for (const PlyProperty& property : element.properties) {
    auto column = property.list_count ? std::nullopt : column_of(property.name);
    if (column && has_[*column]) column = std::nullopt;  // "u" and "texture_u": the first one counts
    if (column) {
      has_[*column] = true;
      // Integer colours cover 0 … their type's largest; float ones 0 … 1. All become 0 … 255.
      const bool is_float = property.type == PlyType::kFloat || property.type == PlyType::kDouble;
      scale[*column] = is_float ? 255.0 : size_of(property.type) == 1 ? 1.0 : 255.0 / 65535.0;
    } else if (!property.list_count) {
      out_.left_out.push_back({"vertex property " + property.name.substr(0, 64), "it is not one that is kept"});
    }
    columns.push_back(column);
  }
  if (!has_[kX] || !has_[kY] || !has_[kZ]) return invalid("element vertex", "x, y or z is missing");
  out_.soup.positions.reserve(element.count);
  for (std::uint64_t v = 0; v < element.count; ++v) {
    std::array<double, kColumnCount> value{};
    value[kAlpha] = 255.0;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      bool is_read = true;
      if (columns[p]) {
        const auto number = next(property.type);
        is_read = number.has_value();
        value[*columns[p]] = number.value_or(0.0) * (*columns[p] >= kRed ? scale[*columns[p]] : 1.0);
      } else {
        is_read = skip(property);
      }
      if (!is_read) {
        return invalid("vertex " + std::to_string(v),
                       "property " + property.name.substr(0, 64) + " is cut short or not a number");
      }
    }
    keep_vertex(value);
  }
  return Ok{};
}

void PlyReader::keep_vertex(const std::array<double, kColumnCount>& value) {
  PolygonSoup& soup = out_.soup;
  soup.positions.emplace_back(value[kX], value[kY], value[kZ]);
  if (has_[kNx] && has_[kNy] && has_[kNz]) soup.normals.emplace_back(value[kNx], value[kNy], value[kNz]);
  if (has_[kU] && has_[kV]) soup.uvs.emplace_back(value[kU], value[kV]);
  if (has_[kRed] && has_[kGreen] && has_[kBlue]) {
    Vec4f color;
    for (std::size_t c = 0; c < 4; ++c) {
      const double level = value[kRed + c];
      // Eight bits of whatever type; NaN becomes 0.
      color[static_cast<int>(c)] = static_cast<std::uint8_t>(level >= 0.0 ? std::min(level + 0.5, 255.0) : 0.0);
    }
    soup.colors.push_back(color / 255.0F);
  }
}

Status PlyReader::read_faces(const PlyElement& element) {
  if (!is_justified(element)) return invalid("element face", "more faces than the file has bytes for");
  std::size_t list = element.properties.size();
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    const PlyProperty& property = element.properties[p];
    if (property.list_count && (property.name == "vertex_indices" || property.name == "vertex_index")) list = p;
  }
  if (element.count > 0 && list == element.properties.size()) {
    return invalid("element face", "vertex_indices is missing");
  }
  // The vertices' count is known from the header even where faces come first.
  std::uint64_t vertex_count = 0;
  for (const PlyElement& other : elements_) {
    if (other.name == "vertex") vertex_count = other.count;
  }
  std::vector<std::uint32_t> corners;
  for (std::uint64_t f = 0; f < element.count; ++f) {
    const std::string where = "face " + std::to_string(f);
    corners.clear();
    bool is_valid = true;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (p != list) {
        if (!skip(property)) return invalid(where, "it is cut short or not a number");
        continue;
      }
      const auto count = next_index(*property.list_count);
      if (!count) return invalid(where, "not a number of corners");
      for (std::uint64_t c = 0; c < *count; ++c) {
        const auto value = next(property.type);
        if (!value) return invalid(where, "it is cut short or not a number");
        const bool is_in_range = *value >= 0.0 && *value < static_cast<double>(vertex_count) &&
                                 static_cast<double>(static_cast<std::uint32_t>(*value)) == *value;
        if (!is_in_range && !options_.repair) {
          return invalid(where,
                         "a vertex index is out of range: there are " + std::to_string(vertex_count) + " vertices");
        }
        is_valid = is_valid && is_in_range;
        corners.push_back(is_in_range ? static_cast<std::uint32_t>(*value) : 0);
      }
    }
    if (corners.size() < 3) {
      ++small_faces_;
      continue;
    }
    if (!is_valid) {
      out_.drops.repaired += corners.size() - 2;
      continue;
    }
    out_.soup.polygon_sizes.push_back(static_cast<std::uint32_t>(corners.size()));
    out_.soup.corners.insert(out_.soup.corners.end(), corners.begin(), corners.end());
  }
  return Ok{};
}

Status PlyReader::skip_element(const PlyElement& element) {
  if (!is_justified(element))
    return invalid("element " + element.name.substr(0, 64), "more than the file has bytes for");
  if (element.count > 0) {
    if (element.name == "tristrips") {
      return Error{ErrorCode::kUnsupported, "element tristrips", "triangle strips in PLY are not supported"};
    }
    out_.left_out.push_back({"element " + element.name.substr(0, 64), "only vertices and faces are read"});
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (!skip(property)) {
        return invalid("element " + element.name.substr(0, 64) + " " + std::to_string(i),
                       "it is cut short or not a number");
      }
    }
  }
  return Ok{};
}

}  // namespace

Result<PolygonFile> read_ply(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  return PlyReader(bytes, options).run();
}

}  // namespace meshlode::scene
