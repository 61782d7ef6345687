// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/obj_face.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

/// An index of OBJ (1 is the first, -1 the last so far), as an absolute one: 0 where it is out of range, nothing where
/// it is no number.
std::optional<std::uint64_t> resolve(std::string_view word, std::uint64_t count) {
  const auto index = parse_integer(word);
  if (!index) return std::nullopt;
  if (*index > 0) {
    const auto positive = static_cast<std::uint64_t>(*index);
    return positive <= count ? positive : 0;
  }
  if (*index == 0 || *index < -static_cast<std::int64_t>(count)) return 0;
  return count - static_cast<std::uint64_t>(-(*index + 1));
}

std::array<std::string_view, 3> split(std::string_view word) {
  std::array<std::string_view, 3> parts;
  for (std::string_view& part : parts) {
    const std::size_t slash = word.find('/');
    part = word.substr(0, slash);
    word = slash == std::string_view::npos ? std::string_view{} : word.substr(slash + 1);
    if (word.empty()) break;
  }
  return parts;
}

}  // namespace

ObjFace parse_obj_face(std::string_view line, const ObjCounts& counts) {
  ObjFace face;
  for (std::string_view word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line)) {
    ++face.stated;
    const auto [position_word, uv_word, normal_word] = split(word);
    const auto position = resolve(position_word, counts.positions);
    const auto uv = uv_word.empty() ? 0 : resolve(uv_word, counts.uvs);
    const auto normal = normal_word.empty() ? 0 : resolve(normal_word, counts.normals);
    const ObjCorner corner{position.value_or(0), uv.value_or(0), normal.value_or(0)};
    face.is_valid = face.is_valid && corner.position != 0;
    face.is_malformed = face.is_malformed || !uv || !normal;
    face.lacks_uvs = face.lacks_uvs || (corner.uv == 0 && !uv_word.empty());
    face.lacks_normals = face.lacks_normals || (corner.normal == 0 && !normal_word.empty());
    if (face.corners.empty() || face.corners.back().position != corner.position) face.corners.push_back(corner);
  }
  while (face.corners.size() > 1 && face.corners.back().position == face.corners.front().position) {
    face.corners.pop_back();
  }
  return face;
}

bool has_three_positions(const std::vector<ObjCorner>& corners) {
  const auto differs = [](std::uint64_t a, std::uint64_t b) {
    return [a, b](const ObjCorner& c) { return c.position != a && c.position != b; };
  };
  if (corners.empty()) return false;
  const std::uint64_t first = corners.front().position;
  const auto second = std::find_if(corners.begin(), corners.end(), differs(first, first));
  return second != corners.end() && std::any_of(second, corners.end(), differs(first, second->position));
}

}  // namespace meshlode::scene
