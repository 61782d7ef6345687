// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: v, vt, vn, f, usemtl and mtllib, whose files are read elsewhere (obj_materials.h); everything else is
// left out.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

constexpr std::size_t kMaxCorners = 4096;     // the search for repeated corners is quadratic
constexpr std::size_t kMaxMaterials = 65536;  // each is a material of the scene, however short its name

Error invalid(std::size_t line, std::string detail) {
  return {ErrorCode::kInvalid, "line " + std::to_string(line), std::move(detail)};
}

class ObjReader {
 public:
  ObjReader(std::string_view text, const ImportOptions& options) : text_(text), options_(options) {}

  Result<PolygonFile> run() {
    std::string joined;
    while (!text_.empty()) {
      ++line_;
      std::string_view line = take_joined_line(text_, joined, line_);
      const std::string_view keyword = take_word(line);
      Status status = Ok{};
      if (keyword == "v") {
        status = read_position(line);
      } else if (keyword == "vt") {
        status = read_uv(line);
      } else if (keyword == "vn") {
        status = read_normal(line);
      } else if (keyword == "f") {
        status = read_face(line);
      } else if (keyword == "usemtl") {
        status = use_material(trimmed(line));
      } else if (keyword == "mtllib") {
        const std::string_view name = trimmed(line);
        if (!name.empty()) libraries_.emplace(name);
      } else if (!keyword.empty() && keyword.front() != '#') {
        skipped_.insert(std::string(keyword.substr(0, 16)));
        if (skipped_.size() > 64) return invalid(line_, "not OBJ: too many unknown keywords");
      }
      if (!status) return status.error();
    }
    return finish();
  }

 private:
  Status read_position(std::string_view line);
  Status read_uv(std::string_view line);
  Status read_normal(std::string_view line);
  Status read_face(std::string_view line);
  Status use_material(std::string_view name);
  void report();
  PolygonFile finish();

  /// A corner of a face: indices from 1, 0 where there is none.
  struct Corner {
    std::uint64_t position = 0, uv = 0, normal = 0;
  };
  /// One vertex for each position and what its corners say of normals and UVs: the position's own the first time.
  class Wedges {
   public:
    explicit Wedges(ObjReader& reader);  ///< takes its positions
    std::uint32_t take(const Corner& corner);
    PolygonSoup soup;

   private:
    using Key = std::array<std::uint32_t, 6>;  // the position and the bits of uv and normal
    const ObjReader& reader_;
    std::vector<bool> is_used_;
    std::map<Key, std::uint32_t> wedges_;
  };

  /// An index of OBJ (1 is the first, -1 the last so far), as an absolute one; nothing where it is out of range.
  static std::optional<std::uint64_t> resolve(std::string_view word, std::uint64_t count) {
    const auto index = parse_integer(word);
    if (!index || *index == 0) return std::nullopt;
    if (*index > 0) {
      const auto positive = static_cast<std::uint64_t>(*index);
      return positive <= count ? std::optional(positive) : std::nullopt;
    }
    if (*index < -static_cast<std::int64_t>(count)) return std::nullopt;
    return count - static_cast<std::uint64_t>(-(*index + 1));
  }

  std::string_view text_;
  const ImportOptions& options_;
  std::size_t line_ = 0;
  std::uint64_t colored_ = 0, small_faces_ = 0, faces_with_uvs_ = 0, faces_with_normals_ = 0;
  bool has_uvs_ = false, has_normals_ = false, has_colors_ = false;
  std::vector<Vec3d> positions_;
  std::vector<Vec3f> colors_;  ///< one per position
  std::vector<Vec2f> uvs_;
  std::vector<Vec3f> normals_;
  std::vector<Corner> corners_;
  std::vector<std::uint32_t> face_sizes_, face_materials_;
  std::map<std::string, std::uint32_t, std::less<>> material_of_;  ///< index by name
  std::uint32_t material_ = kNoId;                                 ///< of the faces that follow
  std::set<std::string> libraries_;
  std::set<std::string> skipped_;
  PolygonFile out_;
};

/// A colour to six digits after the point: three more than 8 bits need.
float six_digits(double level) {
  if (!(level > 0.0)) return 0.0F;
  return level >= 1.0 ? 1.0F : static_cast<float>(std::floor(level * 999999.0 + 0.5) / 1000000.0);
}

/// A number of vt and vn, rounded once. What no float has becomes 0, which a normal of no length and a UV show for what
/// they are; nothing where it is no number.
std::optional<float> parse_float(std::string_view word) {
  const auto number = parse_number(word);
  if (!number) return std::nullopt;
  const double size = std::fabs(*number);
  if (!(size > 1.0e-37 && size <= 3.0e38)) return 0.0F;
  if (word.front() == '+') word.remove_prefix(1);
  float value = 0.0F;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value;
}

Status ObjReader::read_position(std::string_view line) {
  std::array<double, 6> numbers{};
  std::size_t count = 0;
  for (; count < numbers.size(); ++count) {
    const std::string_view word = take_word(line);
    if (word.empty()) break;
    const auto number = parse_number(word);
    if (!number) return invalid(line_, "a coordinate that is not a number");
    numbers[count] = *number;
  }
  if (count < 3) return invalid(line_, "a vertex with fewer than three coordinates");
  positions_.emplace_back(numbers[0], numbers[1], numbers[2]);
  colors_.emplace_back(six_digits(numbers[3]), six_digits(numbers[4]), six_digits(numbers[5]));
  if (count == 6) ++colored_;
  return Ok{};
}

Status ObjReader::read_uv(std::string_view line) {
  const auto u = parse_float(take_word(line));
  const std::string_view second = take_word(line);
  const auto v = second.empty() ? std::optional(0.0F) : parse_float(second);  // "vt u" alone is allowed
  if (!u || !v) return invalid(line_, "a number is missing or not one");
  uvs_.emplace_back(*u, *v);
  return Ok{};
}

Status ObjReader::read_normal(std::string_view line) {
  Vec3f normal;
  for (int c = 0; c < 3; ++c) {
    const auto number = parse_float(take_word(line));
    if (!number) return invalid(line_, "a number is missing or not one");
    normal[c] = *number;
  }
  normals_.push_back(normal);
  return Ok{};
}

Status ObjReader::read_face(std::string_view line) {
  std::vector<Corner> corners;
  bool is_valid = true;
  std::uint64_t corner_count = 0;
  for (std::string_view word = take_word(line); !word.empty(); word = take_word(line)) {
    if (word.front() == '#') break;
    if (++corner_count > kMaxCorners) {
      return Error{ErrorCode::kUnsupported, "line " + std::to_string(line_),
                   "a face of more than " + std::to_string(kMaxCorners) + " corners"};
    }
    std::array<std::string_view, 3> parts;
    std::size_t part = 0;
    for (; part < 3; ++part) {
      const std::size_t slash = word.find('/');
      parts[part] = word.substr(0, slash);
      word = slash == std::string_view::npos ? std::string_view{} : word.substr(slash + 1);
      if (word.empty()) break;
    }
    const auto position = resolve(parts[0], positions_.size());
    const auto uv = parts[1].empty() ? std::optional<std::uint64_t>(0) : resolve(parts[1], uvs_.size());
    const auto normal = parts[2].empty() ? std::optional<std::uint64_t>(0) : resolve(parts[2], normals_.size());
    if (!position || !uv || !normal) {
      if (!options_.repair) return invalid(line_, "a face corner that is not an index, or out of range");
      is_valid = false;
      continue;
    }
    const bool is_known =
        std::any_of(corners.begin(), corners.end(), [&](const Corner& c) { return c.position == *position; });
    if (!is_known) corners.push_back({*position, *uv, *normal});
  }
  if (!is_valid) {
    out_.drops.repaired += corner_count > 2 ? corner_count - 2 : 1;
    return Ok{};
  }
  if (corners.size() < 3) {
    ++small_faces_;
    return Ok{};
  }
  faces_with_uvs_ += std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.uv != 0; }) ? 1U : 0U;
  faces_with_normals_ +=
      std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.normal != 0; }) ? 1U : 0U;
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  face_sizes_.push_back(static_cast<std::uint32_t>(corners.size()));
  face_materials_.push_back(material_);
  return Ok{};
}

Status ObjReader::use_material(std::string_view name) {
  const auto known = material_of_.find(name);
  if (known != material_of_.end()) {
    material_ = known->second;
    return Ok{};
  }
  if (material_of_.size() >= kMaxMaterials) {
    return Error{ErrorCode::kUnsupported, "line " + std::to_string(line_),
                 "more than " + std::to_string(kMaxMaterials) + " materials"};
  }
  material_ = static_cast<std::uint32_t>(material_of_.size());
  material_of_.emplace(name, material_);
  out_.material_names.emplace_back(name);
  return Ok{};
}

ObjReader::Wedges::Wedges(ObjReader& reader) : reader_(reader), is_used_(reader.positions_.size(), false) {
  soup.positions = std::move(reader.positions_);
  if (reader.has_normals_) soup.normals.assign(soup.positions.size(), Vec3f(0.0F));
  if (reader.has_uvs_) soup.uvs.assign(soup.positions.size(), Vec2f(0.0F));
  // White where no face looks, so that such a vertex decides nothing.
  if (reader.has_colors_) soup.colors.assign(soup.positions.size(), Vec4f(1.0F));
}

std::uint32_t ObjReader::Wedges::take(const Corner& corner) {
  const auto position = static_cast<std::uint32_t>(corner.position - 1);
  if (reader_.has_colors_) soup.colors[position] = Vec4f(reader_.colors_[position], 1.0F);
  if (!reader_.has_uvs_ && !reader_.has_normals_) return position;
  const Vec2f uv = reader_.has_uvs_ ? reader_.uvs_[corner.uv - 1] : Vec2f(0.0F);
  const Vec3f normal = reader_.has_normals_ ? reader_.normals_[corner.normal - 1] : Vec3f(0.0F);
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  const Key key{position, bits(uv.x), bits(uv.y), bits(normal.x), bits(normal.y), bits(normal.z)};
  const auto [known, is_new] = wedges_.try_emplace(key, position);
  if (!is_new) return known->second;
  if (is_used_[position]) {
    known->second = static_cast<std::uint32_t>(soup.positions.size());
    soup.positions.push_back(Vec3d(soup.positions[position]));
    if (reader_.has_normals_) soup.normals.emplace_back(0.0F);
    if (reader_.has_uvs_) soup.uvs.emplace_back(0.0F);
    if (reader_.has_colors_) soup.colors.emplace_back(reader_.colors_[position], 1.0F);
  }
  is_used_[position] = true;
  if (reader_.has_uvs_) soup.uvs[known->second] = uv;
  if (reader_.has_normals_) soup.normals[known->second] = normal;
  return known->second;
}

/// What the file has and the scene will not.
void ObjReader::report() {
  if (!has_uvs_ && faces_with_uvs_ != 0) out_.left_out.push_back({"texture coordinates", "not every face has them"});
  if (!has_normals_ && faces_with_normals_ != 0) out_.left_out.push_back({"normals", "not every face has them"});
  if (!has_colors_ && colored_ != 0) out_.left_out.push_back({"colours", "not every vertex has one"});
  if (small_faces_ != 0) {
    out_.left_out.push_back({std::to_string(small_faces_) + " faces", "they have fewer than three distinct corners"});
  }
  for (const std::string& keyword : skipped_) {
    if (keyword == "p" || keyword == "l") {
      out_.left_out.push_back({keyword, "points and lines are not triangles"});
    } else if (keyword != "o" && keyword != "g" && keyword != "s") {
      std::string shown = keyword;
      for (char& c : shown) {
        if (static_cast<unsigned char>(c) < 0x20) c = '?';
      }
      out_.left_out.push_back({shown, "not a keyword that is read"});
    }
  }
}

PolygonFile ObjReader::finish() {
  const std::size_t face_count = face_sizes_.size();
  has_uvs_ = face_count > 0 && faces_with_uvs_ == face_count;
  has_normals_ = face_count > 0 && faces_with_normals_ == face_count;
  has_colors_ = colored_ > 0 && colored_ == colors_.size();
  report();
  Wedges wedges(*this);
  wedges.soup.corners.reserve(corners_.size());
  for (const Corner& corner : corners_) wedges.soup.corners.push_back(wedges.take(corner));
  wedges.soup.polygon_sizes = std::move(face_sizes_);
  if (!out_.material_names.empty()) wedges.soup.polygon_materials = std::move(face_materials_);
  out_.material_libraries.assign(libraries_.begin(), libraries_.end());
  out_.soup = std::move(wedges.soup);
  return std::move(out_);
}

}  // namespace

Result<PolygonFile> read_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  return ObjReader({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, options).run();
}

}  // namespace meshlode::scene
