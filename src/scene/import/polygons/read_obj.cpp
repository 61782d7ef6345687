// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: v, vt, vn, f, o, usemtl and mtllib, whose files are read elsewhere (obj_materials.h); everything else
// is left out.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "base/try.h"
#include "scene/import/polygons/obj_face.h"
#include "scene/import/polygons/obj_objects.h"
#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"
#include "scene/import/polygons/wedges.h"

namespace meshlode::scene {

namespace {

constexpr std::size_t kMaxMaterials = 65536;  // each is a material of the scene, however short its name

Error invalid(std::size_t line, std::string detail) {
  return {ErrorCode::kInvalid, "line " + std::to_string(line), std::move(detail)};
}

/// Names in the order in which they come, each once.
class Names {
 public:
  std::uint32_t number_of(std::string_view name) {
    const auto known = numbers_.find(name);
    if (known != numbers_.end()) return known->second;
    const auto number = static_cast<std::uint32_t>(list.size());
    numbers_.emplace(name, number);
    list.emplace_back(name);
    return number;
  }
  std::vector<std::string> list;

 private:
  std::map<std::string, std::uint32_t, std::less<>> numbers_;
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const ImportOptions& options) : text_(text), options_(options) {}

  Result<PolygonFile> run() {
    std::string joined;
    while (!text_.empty()) {
      ++line_;
      std::string_view line = take_joined_line(text_, joined, line_);
      const std::string_view keyword = take_word(line);
      TRY(read_statement(keyword, line));
    }
    return finish();
  }

 private:
  Status read_statement(std::string_view keyword, std::string_view line);
  Status read_position(std::string_view line);
  Status read_uv(std::string_view line);
  Status read_normal(std::string_view line);
  Status read_face(std::string_view line);
  Status use_material(std::string_view name);
  void keep_face(const ObjFace& face);
  [[nodiscard]] std::uint8_t traits_of(const ObjFace& face);
  void leave_out(std::string what, std::string why) { out_.left_out.push_back({std::move(what), std::move(why)}); }
  void report();
  void make_vertices();
  PolygonFile finish();

  std::string_view text_;
  const ImportOptions& options_;
  std::size_t line_ = 0;
  std::vector<Vec3d> positions_;
  std::vector<Vec3f> colors_;    ///< one per position
  std::vector<bool> has_color_;  ///< of each position
  std::vector<Vec2f> uvs_;
  std::vector<Vec3f> normals_;
  std::vector<ObjCorner> corners_;
  std::uint8_t all_traits_ = 0;                      ///< that any face has
  bool has_flat_ = false;                            ///< faces without normals
  std::uint32_t material_ = kNoId, object_ = kNoId;  ///< of the faces that follow
  Names materials_, objects_, libraries_;
  std::set<std::string, std::less<>> groups_;
  // What is not carried, counted.
  Tally skipped_;
  std::uint64_t small_faces_ = 0, partial_uvs_ = 0, partial_normals_ = 0, partial_colors_ = 0, dangling_uvs_ = 0;
  std::uint64_t dangling_normals_ = 0, clamped_ = 0, weights_ = 0, extra_ = 0, third_uvs_ = 0, smooth_ = 0;
  PolygonFile out_;
};

/// A colour to six digits after the point: three more than 8 bits need.
float six_digits(double level) {
  if (!(level > 0.0)) return 0.0F;
  return level >= 1.0 ? 1.0F : static_cast<float>(std::floor(level * 999999.0 + 0.5) / 1000000.0);
}

/// A number of vt and vn, rounded once: too large is infinite, too small 0; nothing where it is no number.
std::optional<float> parse_float(std::string_view word) {
  const auto number = parse_number(word);
  if (!number) return std::nullopt;
  const double size = std::fabs(*number);
  if (std::isnan(size)) return std::numeric_limits<float>::quiet_NaN();
  if (size > 3.0e38) return std::numeric_limits<float>::infinity();
  if (size <= 1.0e-37) return 0.0F;
  if (word.front() == '+') word.remove_prefix(1);
  float value = 0.0F;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value;
}

/// The next word; empty where a comment begins too.
std::string_view take_value(std::string_view& line) {
  const std::string_view word = take_word(line);
  if (!word.starts_with('#')) return word;
  line = {};
  return {};
}

Status ObjReader::read_statement(std::string_view keyword, std::string_view line) {
  if (keyword == "v") return read_position(line);
  if (keyword == "vt") return read_uv(line);
  if (keyword == "vn") return read_normal(line);
  if (keyword == "f" || keyword == "fo") return read_face(line);
  if (keyword == "usemtl") return use_material(trimmed(line));
  const std::string_view name = trimmed(line);
  if (keyword == "mtllib") {
    if (!name.empty()) libraries_.number_of(name);
  } else if (keyword == "o") {
    object_ = name.empty() ? kNoId : objects_.number_of(name);
  } else if (keyword == "g") {
    if (!name.empty() && !groups_.contains(name)) groups_.emplace(name);
  } else if (keyword == "s") {
    if (!name.empty() && name != "0" && !is_word(name, "off")) ++smooth_;
  } else if (keyword == "#MRGB" || (!keyword.empty() && keyword.front() != '#')) {
    skipped_.add(keyword.substr(0, 16));
    if (skipped_.size() > 64) return invalid(line_, "not OBJ: too many unknown keywords");
  }
  return Ok{};
}

Status ObjReader::read_position(std::string_view line) {
  std::array<double, 6> numbers{};
  std::size_t count = 0;
  for (; count < numbers.size(); ++count) {
    const std::string_view word = take_value(line);
    if (word.empty()) break;
    const auto number = parse_number(word);
    if (!number) return invalid(line_, "a coordinate that is not a number");
    numbers[count] = *number;
  }
  if (count < 3) return invalid(line_, "a vertex with fewer than three coordinates");
  positions_.emplace_back(numbers[0], numbers[1], numbers[2]);
  colors_.emplace_back(six_digits(numbers[3]), six_digits(numbers[4]), six_digits(numbers[5]));
  has_color_.push_back(count == 6);
  if (count == 6 && std::any_of(numbers.begin() + 3, numbers.end(), [](double c) { return !(c >= 0.0 && c <= 1.0); })) {
    ++clamped_;
  }
  if (count == 4 && numbers[3] != 1.0) ++weights_;
  if (count == 5 || (count == 6 && !take_value(line).empty())) ++extra_;
  return Ok{};
}

Status ObjReader::read_uv(std::string_view line) {
  const auto u = parse_float(take_value(line));
  const std::string_view second = take_value(line);
  const auto v = second.empty() ? std::optional(0.0F) : parse_float(second);  // "vt u" alone is allowed
  if (!u || !v) return invalid(line_, "a number is missing or not one");
  if (parse_number(take_value(line)).value_or(0.0) != 0.0) ++third_uvs_;
  uvs_.emplace_back(*u, *v);
  return Ok{};
}

Status ObjReader::read_normal(std::string_view line) {
  Vec3f normal;
  for (int c = 0; c < 3; ++c) {
    const auto number = parse_float(take_value(line));
    if (!number) return invalid(line_, "a number is missing or not one");
    normal[c] = *number;
  }
  normals_.push_back(normal);
  return Ok{};
}

Status ObjReader::read_face(std::string_view line) {
  const ObjFace face = parse_obj_face(line, {positions_.size(), uvs_.size(), normals_.size()});
  if (!face.is_valid && !options_.repair) {
    return invalid(line_, "a corner's position is not an index, or out of range; --repair drops the face");
  }
  if (face.is_malformed && !options_.repair) {
    return invalid(line_, "a corner's texture coordinate or normal is not an index; --repair drops it from the face");
  }
  const std::uint64_t stated = face.stated > 2 ? face.stated - 2 : 0;
  if (!face.is_valid) {
    out_.drops.repaired += std::max<std::uint64_t>(stated, 1);
  } else if (!has_three_positions(face.corners)) {
    ++small_faces_;
  } else {
    keep_face(face);
  }
  return Ok{};
}

void ObjReader::keep_face(const ObjFace& face) {
  const std::vector<ObjCorner>& corners = face.corners;
  dangling_uvs_ += face.lacks_uvs ? 1U : 0U;
  dangling_normals_ += face.lacks_normals ? 1U : 0U;
  const std::uint8_t traits = traits_of(face);
  all_traits_ |= traits;
  has_flat_ = has_flat_ || (traits & kHasNormals) == 0;
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  PolygonSoup& soup = out_.soup;
  soup.polygon_sizes.push_back(static_cast<std::uint32_t>(corners.size()));
  soup.polygon_materials.push_back(material_);
  soup.polygon_objects.push_back(object_);
  soup.polygon_traits.push_back(traits);
}

std::uint8_t ObjReader::traits_of(const ObjFace& face) {
  std::size_t uvs = 0, normals = 0, colors = 0;
  for (const ObjCorner& corner : face.corners) {
    uvs += corner.uv != 0 && !face.lacks_uvs ? 1U : 0U;
    normals += corner.normal != 0 && !face.lacks_normals ? 1U : 0U;
    colors += has_color_[corner.position - 1] ? 1U : 0U;
  }
  const std::size_t all = face.corners.size();
  const auto is_partial = [all](std::size_t count) { return count != 0 && count != all ? 1U : 0U; };
  partial_uvs_ += is_partial(uvs);
  partial_normals_ += is_partial(normals);
  partial_colors_ += is_partial(colors);
  return static_cast<std::uint8_t>((uvs == all ? kHasUvs : 0) | (normals == all ? kHasNormals : 0) |
                                   (colors == all ? kHasColors : 0));
}

Status ObjReader::use_material(std::string_view name) {
  material_ = materials_.number_of(name);
  if (materials_.list.size() <= kMaxMaterials) return Ok{};
  return Error{ErrorCode::kUnsupported, "line " + std::to_string(line_),
               "more than " + std::to_string(kMaxMaterials) + " materials"};
}

/// What the file has and the scene will not.
void ObjReader::report() {
  const auto say = [&](std::uint64_t count, const char* noun, const char* what, const char* why) {
    if (count != 0) leave_out(what, counted(count, noun, *noun == 'v' ? "vertices" : "") + ": " + why);
  };
  say(partial_uvs_, "face", "texture coordinates", "only some corners have them");
  say(dangling_uvs_, "face", "texture coordinates", "they name one that no line before them has");
  say(partial_normals_, "face", "normals", "only some corners have them");
  say(dangling_normals_, "face", "normals", "they name one that no line before them has");
  say(partial_colors_, "face", "colours", "only some corners have them");
  say(clamped_, "vertex", "colours", "a level outside 0 … 1, which is clamped");
  say(weights_, "vertex", "the fourth number of v", "a weight for curves");
  say(extra_, "vertex", "further numbers of v", "more than a position and a colour, or less than both");
  say(third_uvs_, "line", "the third number of vt", "it is not 0");
  if (has_flat_) say(smooth_, "line", "smoothing groups (s)", "without vn a face is flat");
  leave_out_names({groups_.begin(), groups_.end()}, "group", "groups (g) are no meshes", out_.left_out);
  if (small_faces_ != 0) leave_out(counted(small_faces_, "face"), "they have fewer than three distinct corners");
  for (const auto& [keyword, count] : skipped_.counts()) {
    const bool is_line = keyword == "p" || keyword == "l";
    leave_out(shown(keyword), counted(count, "line") +
                                  (is_line ? ": points and lines are not triangles" : ": not a keyword that is read"));
  }
}

/// Positions become vertices, and so does what their corners say of UVs and normals where it differs.
void ObjReader::make_vertices() {
  PolygonSoup& soup = out_.soup;
  soup.positions = std::move(positions_);
  if ((all_traits_ & kHasNormals) != 0) soup.normals.assign(soup.positions.size(), Vec3f(0.0F));
  if ((all_traits_ & kHasUvs) != 0) soup.uvs.assign(soup.positions.size(), Vec2f(0.0F));
  // White where no face looks, so that such a vertex decides nothing.
  if ((all_traits_ & kHasColors) != 0) soup.colors.assign(soup.positions.size(), Vec4f(1.0F));
  WedgeBuilder wedges(soup);
  soup.corners.reserve(corners_.size());
  std::size_t next = 0;
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    const std::uint8_t traits = soup.polygon_traits[p];
    for (const std::size_t end = next + soup.polygon_sizes[p]; next < end; ++next) {
      const ObjCorner& corner = corners_[next];
      const auto position = static_cast<std::uint32_t>(corner.position - 1);
      if ((traits & kHasColors) != 0) soup.colors[position] = Vec4f(colors_[position], 1.0F);
      WedgeAttributes attributes;
      if ((traits & kHasUvs) != 0) attributes.uv = uvs_[corner.uv - 1];
      if ((traits & kHasNormals) != 0) attributes.normal = normals_[corner.normal - 1];
      soup.corners.push_back(wedges.take(position, attributes));
    }
  }
}

PolygonFile ObjReader::finish() {
  report();
  make_vertices();
  PolygonSoup& soup = out_.soup;
  separate_objects(soup, objects_.list, out_.left_out);
  if (materials_.list.empty()) soup.polygon_materials.clear();
  out_.material_names = std::move(materials_.list);
  out_.object_names = std::move(objects_.list);
  out_.material_libraries = std::move(libraries_.list);
  return std::move(out_);
}

}  // namespace

Result<PolygonFile> read_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  return ObjReader(text_of(bytes), options).run();
}

}  // namespace meshlode::scene
