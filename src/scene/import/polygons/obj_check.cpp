// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ: v, vt, vn and f are checked and rewritten with absolute indices; everything else is left out. Above
// all mtllib, whose file OpenMesh would open wherever it points.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "scene/import/polygons/polygon_soup.h"
#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

constexpr std::size_t kMaxCorners = 4096;  // OpenMesh's search for repeated corners is quadratic

Error invalid(std::size_t line, std::string detail) {
  return {ErrorCode::kInvalid, "line " + std::to_string(line), std::move(detail)};
}

class ObjChecker {
 public:
  ObjChecker(std::string_view text, const ImportOptions& options) : text_(text), options_(options) {}

  Result<CheckedMeshFile> run() {
    std::string joined;
    while (!text_.empty()) {
      ++line_;
      std::string_view line = take_line(text_);
      if (!line.empty() && line.back() == '\\') {  // a line that goes on
        joined.assign(line.substr(0, line.size() - 1));
        while (!text_.empty()) {
          ++line_;
          std::string_view more = take_line(text_);
          const bool goes_on = !more.empty() && more.back() == '\\';
          if (goes_on) more.remove_suffix(1);
          joined.append(" ").append(more);
          if (!goes_on) break;
        }
        line = joined;
      }
      const std::string_view keyword = take_word(line);
      Status status = Ok{};
      if (keyword == "v") {
        status = read_position(line);
      } else if (keyword == "vt") {
        status = read_numbers(line, "vt", 2, uv_count_);
      } else if (keyword == "vn") {
        status = read_numbers(line, "vn", 3, normal_count_);
      } else if (keyword == "f") {
        status = read_face(line);
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
  Status read_numbers(std::string_view line, std::string_view keyword, std::size_t count, std::uint64_t& counter);
  Status read_face(std::string_view line);
  CheckedMeshFile finish();

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
  std::uint64_t uv_count_ = 0, normal_count_ = 0, colored_ = 0, small_faces_ = 0, face_count_ = 0;
  std::uint64_t faces_with_uvs_ = 0, faces_with_normals_ = 0;
  std::vector<std::array<double, 3>> colors_;
  std::string uv_lines_, normal_lines_, face_lines_;
  std::set<std::string> skipped_;
  CheckedMeshFile out_;
};

Status ObjChecker::read_position(std::string_view line) {
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
  out_.exact_positions.emplace_back(numbers[0], numbers[1], numbers[2]);
  colors_.push_back({numbers[3], numbers[4], numbers[5]});
  if (count == 6) ++colored_;
  return Ok{};
}

Status ObjChecker::read_numbers(std::string_view line, std::string_view keyword, std::size_t count,
                                std::uint64_t& counter) {
  std::string& lines = keyword == "vt" ? uv_lines_ : normal_lines_;
  lines += keyword;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view word = take_word(line);
    // "vt u" alone is allowed: v is 0.
    const auto number = word.empty() && keyword == "vt" && i == 1 ? std::optional(0.0) : parse_number(word);
    if (!number) return invalid(line_, "a number is missing or not one");
    // What a float stream cannot read would shift every later index: a broken value becomes 0, which a normal of no
    // length and a UV show for what they are.
    const bool is_readable = std::fabs(*number) <= 3.0e38;
    lines += ' ';
    if (is_readable && std::fabs(*number) > 1.0e-37 && !word.empty()) {
      lines += word.front() == '+' ? word.substr(1) : word;
    } else {
      lines += '0';
    }
  }
  lines += '\n';
  ++counter;
  return Ok{};
}

Status ObjChecker::read_face(std::string_view line) {
  struct Corner {
    std::uint64_t position = 0, uv = 0, normal = 0;
  };
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
    const auto position = resolve(parts[0], out_.exact_positions.size());
    const auto uv = parts[1].empty() ? std::optional<std::uint64_t>(0) : resolve(parts[1], uv_count_);
    const auto normal = parts[2].empty() ? std::optional<std::uint64_t>(0) : resolve(parts[2], normal_count_);
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
  ++face_count_;
  faces_with_uvs_ += std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.uv != 0; }) ? 1U : 0U;
  faces_with_normals_ +=
      std::all_of(corners.begin(), corners.end(), [](const Corner& c) { return c.normal != 0; }) ? 1U : 0U;
  face_lines_ += 'f';
  for (const Corner& c : corners) {
    face_lines_ += ' ' + std::to_string(c.position);
    if (c.uv != 0 || c.normal != 0) face_lines_ += '/';
    if (c.uv != 0) face_lines_ += std::to_string(c.uv);
    if (c.normal != 0) face_lines_ += '/' + std::to_string(c.normal);
  }
  face_lines_ += '\n';
  return Ok{};
}

CheckedMeshFile ObjChecker::finish() {
  out_.format = CheckedMeshFile::Format::kObj;
  out_.has_uvs = face_count_ > 0 && faces_with_uvs_ == face_count_;
  out_.has_normals = face_count_ > 0 && faces_with_normals_ == face_count_;
  out_.has_colors = colored_ > 0 && colored_ == colors_.size();
  if (!out_.has_uvs && faces_with_uvs_ != 0)
    out_.left_out.push_back({"texture coordinates", "not every face has them"});
  if (!out_.has_normals && faces_with_normals_ != 0) out_.left_out.push_back({"normals", "not every face has them"});
  if (!out_.has_colors && colored_ != 0) out_.left_out.push_back({"colours", "not every vertex has one"});
  if (small_faces_ != 0) {
    out_.left_out.push_back({std::to_string(small_faces_) + " faces", "they have fewer than three distinct corners"});
  }
  for (const std::string& keyword : skipped_) {
    if (keyword == "mtllib" || keyword == "usemtl") {
      out_.left_out.push_back({keyword, "materials of OBJ are not read"});
    } else if (keyword == "p" || keyword == "l") {
      out_.left_out.push_back({keyword, "points and lines are not triangles"});
    } else if (keyword != "o" && keyword != "g" && keyword != "s") {
      std::string shown = keyword;
      for (char& c : shown) {
        if (static_cast<unsigned char>(c) < 0x20) c = '?';
      }
      out_.left_out.push_back({shown, "not a keyword that is read"});
    }
  }
  std::string& text = out_.text;
  for (const auto& color : colors_) {
    text += "v 0 0 0";  // exact_positions has them with all their digits
    if (out_.has_colors) {
      for (const double c : color) {
        // Three digits more than 8 bits need, and never a form that a float stream cannot read.
        const double level = c >= 0.0 ? std::min(c, 1.0) : 0.0;
        const std::string digits = std::to_string(1000000 + static_cast<int>(level * 999999.0 + 0.5));
        text += level >= 1.0 ? " 1" : " 0." + digits.substr(1);
      }
    }
    text += '\n';
  }
  text += uv_lines_;
  text += normal_lines_;
  text += face_lines_;
  return std::move(out_);
}

}  // namespace

Result<CheckedMeshFile> check_obj(std::span<const std::uint8_t> bytes, const ImportOptions& options) {
  return ObjChecker({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, options).run();
}

}  // namespace meshlode::scene
