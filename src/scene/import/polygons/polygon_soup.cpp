// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/polygon_soup.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace meshlode::scene {

namespace {

/// Twice the area vector of a polygon (Newell), with its first corner as the origin.
Vec3d area_vector(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon) {
  Vec3d sum(0.0);
  const Vec3d& origin = positions[polygon[0]];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    sum += glm::cross(positions[polygon[i]] - origin, positions[polygon[i + 1]] - origin);
  }
  return sum;
}

/// A corner from which the fan's triangles all face the way the polygon does: any corner of a convex polygon, the
/// reflex one of a dented quad. Corner 0 where there is none; a few are tried, so that a huge polygon stays linear.
std::size_t find_fan_corner(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon) {
  constexpr std::size_t kTries = 16;
  const std::size_t n = polygon.size();
  if (n == 3) return 0;
  const Vec3d whole = area_vector(positions, polygon);
  for (std::size_t start = 0; start < std::min(n, kTries); ++start) {
    bool is_good = true;
    const Vec3d& origin = positions[polygon[start]];
    for (std::size_t i = 1; i + 1 < n && is_good; ++i) {
      const Vec3d part =
          glm::cross(positions[polygon[(start + i) % n]] - origin, positions[polygon[(start + i + 1) % n]] - origin);
      is_good = glm::dot(part, whole) > 0.0;
    }
    if (is_good) return start;
  }
  return 0;
}

bool is_stored_exactly(const Vec3d& p) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::fabs(p.x) <= kMax && std::fabs(p.y) <= kMax && std::fabs(p.z) <= kMax;  // false for NaN
}

/// The triangles of `corners` with the vertices that they name, in order.
Primitive part_of(const Primitive& whole, std::vector<std::uint32_t> corners) {
  std::vector<std::uint32_t> used = corners;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.reserve(used.size());
    for (const std::uint32_t v : used) to.push_back(from[v]);
  };
  Primitive out;
  gather(whole.positions, out.positions);
  gather(whole.normals, out.normals);
  gather(whole.uvs[0], out.uvs[0]);
  gather(whole.colors, out.colors);
  for (std::uint32_t& corner : corners) {
    corner = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), corner) - used.begin());
  }
  out.indices = std::move(corners);
  return out;
}

MaterialId material_id(std::uint32_t material) {
  return material == kNoId ? MaterialId() : MaterialId(std::size_t{material});
}

/// One primitive for each material. `materials`: of the triangles, or empty.
std::vector<Primitive> split(Primitive whole, const std::vector<std::uint32_t>& materials) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> corners;  // kNoId is the last
  for (std::size_t t = 0; t < materials.size(); ++t) {
    std::vector<std::uint32_t>& list = corners[materials[t]];
    list.insert(list.end(), whole.indices.begin() + static_cast<std::ptrdiff_t>(3 * t),
                whole.indices.begin() + static_cast<std::ptrdiff_t>(3 * t + 3));
  }
  std::vector<Primitive> out;
  if (corners.size() < 2) {
    if (!corners.empty()) whole.material = material_id(corners.begin()->first);
    out.push_back(std::move(whole));
    return out;
  }
  for (auto& [material, list] : corners) {
    out.push_back(part_of(whole, std::move(list)));
    out.back().material = material_id(material);
  }
  return out;
}

template <class Vec>
std::size_t replace_broken(std::vector<Vec>& values, int components, const Vec& stand_in, bool is_direction) {
  std::size_t bad = 0;
  for (Vec& value : values) {
    bool is_finite = true;
    bool is_zero = true;
    for (int c = 0; c < components; ++c) {
      is_finite = is_finite && std::isfinite(value[c]);
      is_zero = is_zero && value[c] == 0.0F;
    }
    if (is_finite && !(is_direction && is_zero)) continue;
    value = stand_in;
    ++bad;
  }
  return bad;
}

}  // namespace

Result<std::vector<Primitive>> triangulate(PolygonSoup soup, const ImportOptions& options, ImportDrops& drops,
                                           std::vector<LeftOut>& left_out) {
  Primitive out;
  bool needs_compaction = false;
  for (std::size_t v = 0; v < soup.positions.size(); ++v) {
    if (is_stored_exactly(soup.positions[v])) continue;
    if (!options.repair) {
      return Error{ErrorCode::kInvalid, "vertex " + std::to_string(v),
                   "its position is not finite, or beyond what a float can hold"};
    }
    needs_compaction = true;
  }
  out.indices.reserve(soup.corners.size());
  std::vector<std::uint32_t> materials;
  std::size_t first = 0;
  for (std::size_t p = 0; p < soup.polygon_sizes.size(); ++p) {
    const std::uint32_t size = soup.polygon_sizes[p];
    const std::span<const std::uint32_t> polygon(soup.corners.data() + first, size);
    first += size;
    const bool is_whole = !needs_compaction || std::all_of(polygon.begin(), polygon.end(), [&](std::uint32_t v) {
      return is_stored_exactly(soup.positions[v]);
    });
    if (!is_whole) {
      drops.repaired += size - 2;
      continue;
    }
    if (!soup.polygon_materials.empty()) materials.insert(materials.end(), size - 2, soup.polygon_materials[p]);
    const std::size_t start = find_fan_corner(soup.positions, polygon);
    for (std::size_t i = 1; i + 1 < size; ++i) {
      out.indices.insert(out.indices.end(),
                         {polygon[start], polygon[(start + i) % size], polygon[(start + i + 1) % size]});
    }
  }
  out.positions = std::move(soup.positions);
  out.normals = std::move(soup.normals);
  out.uvs[0] = std::move(soup.uvs);
  out.colors = std::move(soup.colors);
  if (needs_compaction) {
    std::vector<std::uint32_t> corners = std::move(out.indices);
    out = part_of(out, std::move(corners));
  }
  if (const std::size_t bad = replace_broken(out.normals, 3, Vec3f(0.0F, 0.0F, 1.0F), true); bad != 0) {
    // Half a set of normals is worse than none: flat ones are what a file without normals gets.
    out.normals.clear();
    left_out.push_back({"normals", std::to_string(bad) + " are not finite or have no length; flat ones stand in"});
  }
  if (const std::size_t bad = replace_broken(out.uvs[0], 2, Vec2f(0.0F), false); bad != 0) {
    left_out.push_back({"texture coordinates", std::to_string(bad) + " are not finite; zero stands in for them"});
  }
  if (const std::size_t bad = replace_broken(out.colors, 4, Vec4f(1.0F), false); bad != 0) {
    left_out.push_back({"colours", std::to_string(bad) + " are not finite; white stands in for them"});
  }
  for (Vec4f& color : out.colors) {
    for (int c = 0; c < 4; ++c) color[c] = std::clamp(color[c], 0.0F, 1.0F);
  }
  return split(std::move(out), materials);
}

}  // namespace meshlode::scene
