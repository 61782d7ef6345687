// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/obj_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "scene/import/polygons/text_scan.h"

namespace meshlode::scene {

namespace {

constexpr std::size_t kMaxMeshes = 65536;  // each has a root and tables of its own

/// A corner's place with what has it.
struct Use {
  std::array<double, 3> place;
  std::uint32_t object;
  bool operator<(const Use& other) const { return place != other.place ? place < other.place : object < other.object; }
};

/// One for each object and position; what is not finite is in no place.
std::vector<Use> find_uses(const PolygonSoup& soup) {
  std::vector<std::uint32_t> last(soup.positions.size(), 0);  // by position: 1 + the place in `uses`
  std::vector<Use> uses;
  std::size_t corner = 0;
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    const std::uint32_t object = soup.polygon_objects[p];
    for (const std::size_t end = corner + soup.polygon_sizes[p]; corner < end; ++corner) {
      const std::uint32_t v = soup.corners[corner];
      const Vec3d place = soup.positions[v] + 0.0;  // -0 is 0
      if (!std::isfinite(place.x) || !std::isfinite(place.y) || !std::isfinite(place.z)) continue;
      if (last[v] != 0 && uses[last[v] - 1].object == object) continue;
      uses.push_back({{place.x, place.y, place.z}, object});
      last[v] = static_cast<std::uint32_t>(uses.size());
    }
  }
  return uses;
}

std::vector<bool> find_joined(const PolygonSoup& soup, std::size_t object_count) {
  std::vector<bool> is_joined(object_count, object_count > kMaxMeshes);
  std::vector<Use> uses = find_uses(soup);
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 1; i < uses.size(); ++i) {
    if (uses[i].place != uses[i - 1].place || uses[i].object == uses[i - 1].object) continue;
    for (const std::uint32_t object : {uses[i - 1].object, uses[i].object}) {
      if (object != kNoId) is_joined[object] = true;
    }
  }
  return is_joined;
}

}  // namespace

void leave_out_names(const std::vector<std::string>& names, const char* noun, const char* why,
                     std::vector<LeftOut>& left_out) {
  if (names.empty()) return;
  constexpr std::size_t kMostShown = 8;  // a line of the terminal or two
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMostShown); ++i) list += (i == 0 ? "" : ", ") + shown(names[i]);
  if (names.size() > kMostShown) list += " …";
  left_out.push_back({"the names of " + counted(names.size(), noun), why + (": " + list)});
}

void separate_objects(PolygonSoup& soup, const std::vector<std::string>& names, std::vector<LeftOut>& left_out) {
  if (names.empty()) return;
  const std::vector<bool> is_joined = find_joined(soup, names.size());
  std::vector<bool> has_faces(names.size(), false);
  for (std::uint32_t& object : soup.polygon_objects) {
    if (object == kNoId) continue;
    has_faces[object] = true;
    if (is_joined[object]) object = kNoId;
  }
  std::vector<std::string> joined, empty;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!has_faces[i]) empty.push_back(names[i]);
    if (has_faces[i] && is_joined[i]) joined.push_back(names[i]);
  }
  leave_out_names(joined, "object",
                  names.size() > kMaxMeshes ? "there are too many" : "they share positions and stay one mesh",
                  left_out);
  leave_out_names(empty, "object", "they have no faces", left_out);
}

}  // namespace meshlode::scene
