// SPDX-License-Identifier: GPL-3.0-or-later
// PLY (Turk 1994), ascii and both binary orders: every element is walked; vertices, faces and strips are kept.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>

#include "base/try.h"
#include "scene/import/polygons/ply_body.h"
#include "scene/import/polygons/ply_colors.h"
#include "scene/import/polygons/ply_columns.h"
#include "scene/import/polygons/ply_header.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"
#include "scene/import/polygons/wedges.h"

namespace meshlode::scene {

namespace {

Error invalid(std::string where, std::string detail) {
  return {ErrorCode::kInvalid, std::move(where), std::move(detail)};
}

using Values = std::array<double, kColumnCount>;

Vec4f color_of(const Values& value) {
  return {value[kRed], value[kGreen], value[kBlue], value[kAlpha]};
}

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, std::string_view body, const ImportOptions& options)
      : header_(header), body_(header, body), options_(options) {
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex") vertex_count_ = element.count;  // known even where faces come first
    }
  }

  Result<PolygonFile> run() {
    for (const PlyElement& element : header_.elements) {
      TRY_LET(status, element.name == "vertex"      ? read_vertices(element)
                      : element.name == "face"      ? read_faces(element)
                      : element.name == "tristrips" ? read_strips(element)
                                                    : skip_element(element));
    }
    return finish();
  }

 private:
  Status read_vertices(const PlyElement& element);
  Status read_faces(const PlyElement& element);
  Status read_strips(const PlyElement& element);
  Status skip_element(const PlyElement& element);
  /// The indices of a list; where one is no vertex, it is refused, or else `is_valid` becomes false. -1 is one where
  /// `has_breaks`.
  Status read_indices(const PlyProperty& property, const std::string& where, bool has_breaks,
                      std::vector<std::int64_t>& out, bool& is_valid);
  Status read_wedges(const PlyProperty& property, const std::string& where);
  void keep_vertex(const PlyColumns& set, const Values& value);
  void keep_face(const PlyColumns& set, const Values& value, bool is_valid);
  void keep_strip(const std::vector<std::int64_t>& strip, bool is_valid);
  void leave_out(std::string what, std::string why) { out_.left_out.push_back({std::move(what), std::move(why)}); }
  void leave_out_properties(const PlyElement& element, const std::vector<bool>& is_kept);
  void add_materials();
  void make_wedges();
  PolygonFile finish();

  const PlyHeader& header_;
  PlyBody body_;
  const ImportOptions& options_;
  std::uint64_t vertex_count_ = 0;
  PlyColors vertex_colors_, face_colors_;
  bool has_wedges_ = false, has_texture_numbers_ = false;
  std::vector<std::int64_t> corners_;        ///< of the face that is read
  std::vector<Vec2f> wedge_uvs_, face_uvs_;  ///< one per corner of all faces, and of the face that is read
  std::uint64_t wedge_numbers_ = 0;          ///< of the face that is read
  std::vector<bool> face_has_uvs_;
  std::vector<double> texture_numbers_;
  std::uint64_t small_faces_ = 0, odd_wedges_ = 0, odd_textures_ = 0, clamped_ = 0;
  PolygonFile out_;
};

void PlyReader::leave_out_properties(const PlyElement& element, const std::vector<bool>& is_kept) {
  if (element.count == 0) return;
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (is_kept[p]) continue;
    leave_out(element.name + " property " + shown(element.properties[p].name),
              "it is not one that is kept: " +
                  counted(element.count, element.name, element.name == "vertex" ? "vertices" : ""));
  }
}

Status PlyReader::read_vertices(const PlyElement& element) {
  if (!body_.is_justified(element)) return invalid("element vertex", "more vertices than the file has bytes for");
  const PlyColumns set(element, {{kX, kY, kZ}, {kNx, kNy, kNz}, {kU, kV}, {kRed, kGreen, kBlue}});
  if (!set.has[kX]) return invalid("element vertex", "x, y or z is missing");
  std::vector<bool> is_kept;
  for (const auto& column : set.columns) is_kept.push_back(column.has_value());
  leave_out_properties(element, is_kept);
  vertex_colors_.type = set.color_type;
  vertex_colors_.has_alpha = set.has[kAlpha];
  out_.soup.positions.reserve(element.count);
  for (std::uint64_t v = 0; v < element.count; ++v) {
    Values value{};
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      bool is_read = true;
      if (set.columns[p]) {
        const auto number = body_.next(property.type);
        is_read = number.has_value();
        value[*set.columns[p]] = number.value_or(0.0);
      } else {
        is_read = body_.skip(property);
      }
      if (!is_read) {
        return invalid("vertex " + std::to_string(v),
                       "property " + shown(property.name) + " is cut short or not a number");
      }
    }
    body_.end_row();
    keep_vertex(set, value);
  }
  return Ok{};
}

void PlyReader::keep_vertex(const PlyColumns& set, const Values& value) {
  PolygonSoup& soup = out_.soup;
  soup.positions.emplace_back(value[kX], value[kY], value[kZ]);
  if (set.has[kNx]) soup.normals.emplace_back(value[kNx], value[kNy], value[kNz]);
  if (set.has[kU]) soup.uvs.emplace_back(value[kU], value[kV]);
  if (set.has[kRed]) vertex_colors_.raw.push_back(color_of(value));
}

Status PlyReader::read_indices(const PlyProperty& property, const std::string& where, bool has_breaks,
                               std::vector<std::int64_t>& out, bool& is_valid) {
  out.clear();
  const auto count = body_.next_count(*property.list_count);
  if (!count) return invalid(where, "not a number of corners");
  for (std::uint64_t c = 0; c < *count; ++c) {
    const auto value = body_.next(property.type);
    if (!value) return invalid(where, "it is cut short or not a number");
    const bool is_break = has_breaks && *value == -1.0;
    const bool is_in_range = is_break || (*value >= 0.0 && *value < static_cast<double>(vertex_count_) &&
                                          static_cast<double>(static_cast<std::uint32_t>(*value)) == *value);
    if (!is_in_range && !options_.repair) {
      return invalid(where, "a vertex index is out of range: there are " + std::to_string(vertex_count_) + " vertices");
    }
    is_valid = is_valid && is_in_range;
    out.push_back(is_in_range ? static_cast<std::int64_t>(*value) : 0);
  }
  return Ok{};
}

/// Two numbers for each corner; how many corners there are is known when the whole face is.
Status PlyReader::read_wedges(const PlyProperty& property, const std::string& where) {
  const auto count = body_.next_count(*property.list_count);
  if (!count) return invalid(where, "not a number of texture coordinates");
  float u = 0.0F;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto value = body_.next(property.type);
    if (!value) return invalid(where, "it is cut short or not a number");
    if (i % 2 == 0) u = static_cast<float>(*value);
    if (i % 2 == 1) face_uvs_.emplace_back(u, static_cast<float>(*value));
  }
  wedge_numbers_ = *count;
  return Ok{};
}

Status PlyReader::read_faces(const PlyElement& element) {
  if (!body_.is_justified(element)) return invalid("element face", "more faces than the file has bytes for");
  const PlyColumns set(element, {{kRed, kGreen, kBlue}, {kTexture}});
  const std::size_t none = element.properties.size();
  const auto find_list = [&](auto is_name) {
    std::size_t p = 0;
    while (p < none && !(element.properties[p].list_count && is_name(element.properties[p].name))) ++p;
    return p;
  };
  const std::size_t list = find_list([](std::string_view n) { return n == "vertex_indices" || n == "vertex_index"; });
  const std::size_t wedges = find_list([](std::string_view n) { return n == "texcoord" || n == "texcoords"; });
  if (element.count > 0 && list == none) return invalid("element face", "vertex_indices is missing");
  std::vector<bool> is_kept;
  for (std::size_t p = 0; p < none; ++p) is_kept.push_back(p == list || p == wedges || set.columns[p]);
  leave_out_properties(element, is_kept);
  has_wedges_ = element.count > 0 && wedges != none;
  has_texture_numbers_ = element.count > 0 && set.has[kTexture];
  face_colors_.type = set.color_type;
  face_colors_.has_alpha = set.has[kAlpha];
  for (std::uint64_t f = 0; f < element.count; ++f) {
    const std::string where = "face " + std::to_string(f);
    Values value{};
    bool is_valid = true;
    face_uvs_.clear();
    for (std::size_t p = 0; p < none; ++p) {
      const PlyProperty& property = element.properties[p];
      Status status = Ok{};
      if (p == list) {
        status = read_indices(property, where, false, corners_, is_valid);
      } else if (p == wedges) {
        status = read_wedges(property, where);
      } else if (set.columns[p]) {
        const auto number = body_.next(property.type);
        if (!number) status = invalid(where, "it is cut short or not a number");
        value[*set.columns[p]] = number.value_or(0.0);
      } else if (!body_.skip(property)) {
        status = invalid(where, "it is cut short or not a number");
      }
      if (!status) return status;
    }
    body_.end_row();
    keep_face(set, value, is_valid);
  }
  return Ok{};
}

void PlyReader::keep_face(const PlyColumns& set, const Values& value, bool is_valid) {
  if (corners_.size() < 3) {
    ++small_faces_;
    return;
  }
  if (!is_valid) {
    out_.drops.repaired += corners_.size() - 2;
    return;
  }
  out_.soup.polygon_sizes.push_back(static_cast<std::uint32_t>(corners_.size()));
  out_.soup.corners.insert(out_.soup.corners.end(), corners_.begin(), corners_.end());
  if (has_wedges_) {
    const bool has_uvs = wedge_numbers_ == 2 * corners_.size();
    if (!has_uvs && wedge_numbers_ != 0) ++odd_wedges_;
    face_uvs_.resize(corners_.size(), Vec2f(0.0F));
    wedge_uvs_.insert(wedge_uvs_.end(), face_uvs_.begin(), face_uvs_.end());
    face_has_uvs_.push_back(has_uvs);
  }
  if (set.has[kTexture]) texture_numbers_.push_back(value[kTexture]);
  if (set.has[kRed]) face_colors_.raw.push_back(color_of(value));
}

/// Each three indices in a row are a triangle, of which every second is turned; -1 begins a new strip.
Status PlyReader::read_strips(const PlyElement& element) {
  if (!body_.is_justified(element)) return invalid("element tristrips", "more strips than the file has bytes for");
  std::size_t list = 0;
  while (list < element.properties.size() &&
         !(element.properties[list].list_count && element.properties[list].name.starts_with("vertex_ind"))) {
    ++list;
  }
  if (element.count > 0 && list == element.properties.size()) {
    return invalid("element tristrips", "vertex_indices is missing");
  }
  if (element.count > 0 && std::any_of(header_.elements.begin(), header_.elements.end(), [](const PlyElement& other) {
        return other.name == "face" && other.count > 0;
      })) {
    return Error{ErrorCode::kUnsupported, "element tristrips", "triangle strips beside faces are not supported"};
  }
  std::vector<bool> is_kept(element.properties.size(), false);
  if (element.count > 0) is_kept[list] = true;
  leave_out_properties(element, is_kept);
  std::vector<std::int64_t> strip;
  for (std::uint64_t s = 0; s < element.count; ++s) {
    const std::string where = "strip " + std::to_string(s);
    bool is_valid = true;
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      Status status = Ok{};
      if (p == list) {
        status = read_indices(element.properties[p], where, true, strip, is_valid);
      } else if (!body_.skip(element.properties[p])) {
        status = invalid(where, "it is cut short or not a number");
      }
      if (!status) return status;
    }
    body_.end_row();
    keep_strip(strip, is_valid);
  }
  return Ok{};
}

void PlyReader::keep_strip(const std::vector<std::int64_t>& strip, bool is_valid) {
  std::size_t begin = 0;  // of the strip since the last break
  for (std::size_t i = 0; i < strip.size(); ++i) {
    if (strip[i] < 0) begin = i + 1;
    if (i < begin + 2 || strip[i - 2] == strip[i - 1] || strip[i - 1] == strip[i] || strip[i - 2] == strip[i]) continue;
    corners_ = {strip[i - 2], strip[i - 1], strip[i]};
    if ((i - begin) % 2 == 1) std::swap(corners_[0], corners_[1]);
    if (!is_valid) {
      ++out_.drops.repaired;
      continue;
    }
    out_.soup.polygon_sizes.push_back(3);
    out_.soup.corners.insert(out_.soup.corners.end(), corners_.begin(), corners_.end());
  }
}

Status PlyReader::skip_element(const PlyElement& element) {
  const std::string name = shown(element.name);
  if (!element.properties.empty() && !body_.is_justified(element)) {
    return invalid("element " + name, "more than the file has bytes for");
  }
  if (element.count > 0) {
    leave_out("element " + name, std::to_string(element.count) + " of it; only vertices and faces are read");
  }
  if (element.properties.empty()) return Ok{};
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (!body_.skip(property)) {
        return invalid("element " + name + " " + std::to_string(i), "it is cut short or not a number");
      }
    }
    body_.end_row();
  }
  return Ok{};
}

/// Attributes of corners and of whole faces become vertices of their own.
void PlyReader::make_wedges() {
  PolygonSoup& soup = out_.soup;
  const bool has_wedges = std::find(face_has_uvs_.begin(), face_has_uvs_.end(), true) != face_has_uvs_.end();
  if (has_wedges && !soup.uvs.empty()) leave_out("vertex properties of texture coordinates", "faces have their own");
  if (has_wedges) soup.uvs.assign(soup.positions.size(), Vec2f(0.0F));
  const bool paints_faces = !face_colors_.raw.empty() && vertex_colors_.raw.empty();
  if (!face_colors_.raw.empty() && !paints_faces) {
    leave_out("face properties red, green and blue",
              counted(face_colors_.raw.size(), "face") + "; the vertices have colours too");
  }
  soup.colors = vertex_colors_.take(options_.linear_colors, clamped_);
  std::vector<Vec4f> face_colors;
  if (paints_faces) {
    face_colors = face_colors_.take(options_.linear_colors, clamped_);
    soup.colors.assign(soup.positions.size(), Vec4f(1.0F));
  }
  if (!has_wedges && !paints_faces) return;
  WedgeBuilder wedges(soup);
  std::size_t corner = 0;
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    WedgeAttributes attributes;
    if (paints_faces) attributes.color = face_colors[p];
    for (const std::size_t end = corner + soup.polygon_sizes[p]; corner < end; ++corner) {
      if (has_wedges && face_has_uvs_[p]) attributes.uv = wedge_uvs_[corner];
      soup.corners[corner] = wedges.take(soup.corners[corner], attributes);
    }
    if (has_wedges) soup.polygon_traits.push_back(face_has_uvs_[p] ? kHasAll : kHasNormals | kHasColors);
  }
}

/// One material for each texture; a face without texture coordinates has none.
void PlyReader::add_materials() {
  PolygonSoup& soup = out_.soup;
  const std::size_t count = header_.textures.size();
  if (soup.uvs.empty() || count == 0) {
    for (const std::string& name : header_.textures) {
      leave_out("TextureFile " + shown(name), "the file has no texture coordinates");
    }
    if (has_texture_numbers_) leave_out("face property texnumber", "no comment TextureFile says what it counts");
    return;
  }
  for (const std::string& name : header_.textures) {
    MtlMaterial material;
    material.name = std::filesystem::path(name).stem().string();
    material.base_color.file = name;
    material.base_color.keyword = "TextureFile";
    out_.materials.push_back(std::move(material));
  }
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    const bool has_uvs = soup.polygon_traits.empty() || (soup.polygon_traits[p] & kHasUvs) != 0;
    const double number = p < texture_numbers_.size() ? texture_numbers_[p] : 0.0;
    const bool is_known = number >= 0.0 && number < static_cast<double>(count);
    if (!is_known && number != -1.0) ++odd_textures_;
    soup.polygon_materials.push_back(has_uvs && is_known ? static_cast<std::uint32_t>(number) : kNoId);
  }
  if (!has_texture_numbers_ && count > 1) {
    leave_out(counted(count - 1, "TextureFile"), "no face property texnumber says which face has it");
  }
}

PolygonFile PlyReader::finish() {
  make_wedges();
  add_materials();
  if (small_faces_ != 0) leave_out(counted(small_faces_, "face"), "they have fewer than three corners");
  if (odd_wedges_ != 0) {
    leave_out("texture coordinates (texcoord)",
              counted(odd_wedges_, "face") + " with another number than two a corner");
  }
  if (odd_textures_ != 0)
    leave_out("face property texnumber", counted(odd_textures_, "face") + " without such a texture");
  if (clamped_ != 0) leave_out("colours", std::to_string(clamped_) + " outside of what their type covers are clamped");
  for (const auto& [keyword, lines] : header_.other.counts()) {
    leave_out("header keyword " + shown(keyword), counted(lines, "line"));
  }
  if (body_.surplus() != 0) {
    leave_out(counted(body_.surplus(), "number"), "rows have more than the header says, at their ends");
  }
  if (body_.rest() != 0) leave_out(counted(body_.rest(), "byte"), "they follow the last element");
  return std::move(out_);
}

}  // namespace

Result<PolygonFile> read_ply(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  std::string_view text = text_of(bytes);
  TRY_LET(header, take_ply_header(text));
  return PlyReader(*header, text, options).run();
}

}  // namespace meshlode::scene
