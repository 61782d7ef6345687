// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/import/polygons/face_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <set>
#include <string>

#include "scene/import/polygons/text_scan.h"
#include "scene/import/polygons/triangulate_polygon.h"

namespace meshlode::scene {

namespace {

/// Polygons of up to this many corners do not count towards the bound of the work.
constexpr std::size_t kSmall = 64;
constexpr std::uint64_t kMaxWork = std::uint64_t{1} << 31U;

/// Twice the area vector of a polygon (Newell), with its first corner as the origin.
Vec3d area_vector(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon) {
  Vec3d sum(0.0);
  const Vec3d& origin = positions[polygon[0]];
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    sum += glm::cross(positions[polygon[i]] - origin, positions[polygon[i + 1]] - origin);
  }
  return sum;
}

/// The same; where it is 0, because parts of the polygon run one way around and parts the other, of the first part.
Vec3d any_area_vector(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon) {
  Vec3d area = area_vector(positions, polygon);
  for (std::size_t i = 1; area == Vec3d(0.0) && i + 1 < polygon.size(); ++i) {
    area = area_vector(positions, std::array{polygon[0], polygon[i], polygon[i + 1]});
  }
  return area;
}

using Fan = FaceTriangles::Fan;

Fan fan_from(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon, std::size_t start,
             const Vec3d& whole) {
  const std::size_t n = polygon.size();
  const Vec3d& origin = positions[polygon[start]];
  Fan fan{start, true, false};
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double part = glm::dot(
        glm::cross(positions[polygon[(start + i) % n]] - origin, positions[polygon[(start + i + 1) % n]] - origin),
        whole);
    fan.is_good = fan.is_good && part > 0.0;
    fan.is_folded = fan.is_folded || part < 0.0;
  }
  return fan;
}

/// From any corner of a convex polygon, the reflex one of a dented quad; corner 0 where there is none that is good. A
/// few are tried, so that a huge polygon stays linear.
Fan find_fan(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> polygon, const Vec3d& whole) {
  constexpr std::size_t kTries = 16;
  Fan first;
  for (std::size_t start = 0; start < std::min(polygon.size(), kTries); ++start) {
    const Fan fan = fan_from(positions, polygon, start, whole);
    if (fan.is_good) return fan;
    if (start == 0) first = fan;
  }
  return first;
}

/// The two coordinates in which the polygon is largest, as they are, so that the way around stays what it is. What lies
/// on a line stays on it, and no digit is lost.
std::array<int, 2> plane_axes(const Vec3d& area) {
  const Vec3d size = glm::abs(area);
  const int axis = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  return area[axis] >= 0.0 ? std::array{first, second} : std::array{second, first};
}

}  // namespace

bool FaceTriangles::append_triangulated(std::span<const std::uint32_t> polygon, const Vec3d& area,
                                        std::vector<std::uint32_t>& indices) {
  const std::uint64_t n = polygon.size();
  if (n > kSmall) {
    if (n > kMaxTriangulatedCorners || work_ + n * n > kMaxWork) {
      ++too_large_;
      return false;
    }
    work_ += n * n;
  }
  const std::array<int, 2> axes = plane_axes(area);
  std::vector<std::array<double, 2>> points;
  points.reserve(n);
  for (const std::uint32_t v : polygon) points.push_back({positions_[v][axes[0]], positions_[v][axes[1]]});
  PolygonTriangles made = triangulate_polygon(points);
  if (made.triangles.empty()) {
    ++crossing_;
    return append_first_visits(polygon, indices);
  }
  crossing_ += made.is_simple ? 0 : 1;
  if (made.is_simple && !add_spikes(polygon, area, made)) ++bent_;
  for (const auto& [a, b, c] : made.triangles) indices.insert(indices.end(), {polygon[a], polygon[b], polygon[c]});
  return true;
}

bool FaceTriangles::add_spikes(std::span<const std::uint32_t> polygon, const Vec3d& area,
                               PolygonTriangles& made) const {
  constexpr double kRounding = 1e-11;  // of the areas that are added up, for up to kMaxTriangulatedCorners of them
  const auto n = static_cast<std::uint32_t>(polygon.size());
  std::set<std::array<double, 3>> places, used;
  const auto place = [&](std::uint32_t corner) {
    const Vec3d& p = positions_[polygon[corner]];
    return std::array{p.x, p.y, p.z};
  };
  const auto area_of = [&](const std::array<std::uint32_t, 3>& t) {
    return area_vector(positions_, std::array{polygon[t[0]], polygon[t[1]], polygon[t[2]]});
  };
  double added = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    places.insert(place(i));
    if (i > 0 && i + 1 < n) added += glm::length(area_of({0, i, i + 1}));
  }
  for (const auto& t : made.triangles) {
    for (const std::uint32_t corner : t) used.insert(place(corner));
  }
  if (used.size() < places.size()) {
    const std::uint32_t begin = made.triangles[0][0];
    std::uint32_t last_used = begin;
    std::vector<std::array<std::uint32_t, 3>> spike;  // of the corners since that one
    double size = 0.0;
    for (std::uint32_t step = 1; step <= n; ++step) {
      const std::uint32_t corner = (begin + step) % n, before = (begin + step - 1) % n;
      if (before != last_used && place(before) != place(corner)) {
        spike.push_back({last_used, before, corner});
        size += glm::length(area_of(spike.back()));
      }
      if (!used.contains(place(corner))) continue;
      if (size > kRounding * added) made.triangles.insert(made.triangles.end(), spike.begin(), spike.end());
      last_used = corner;
      spike.clear();
      size = 0.0;
    }
  }
  Vec3d missing = area;
  for (const auto& t : made.triangles) missing -= area_of(t);
  return glm::length(missing) <= kRounding * added || places.size() < n;
}

bool FaceTriangles::append_first_visits(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices) {
  std::vector<std::uint32_t> once;
  std::set<std::array<double, 3>> places;
  for (const std::uint32_t v : polygon) {
    const Vec3d& p = positions_[v];
    if (places.insert({p.x, p.y, p.z}).second) once.push_back(v);
  }
  if (once.size() < 3 || once.size() == polygon.size()) return false;
  append_fan(once, find_fan(positions_, once, area_vector(positions_, once)), indices);
  return true;
}

void FaceTriangles::append_fan(std::span<const std::uint32_t> polygon, const Fan& fan,
                               std::vector<std::uint32_t>& indices) {
  const std::size_t n = polygon.size();
  for (std::size_t i = 1; i + 1 < n; ++i) {
    indices.insert(indices.end(), {polygon[fan.start], polygon[(fan.start + i) % n], polygon[(fan.start + i + 1) % n]});
  }
}

void FaceTriangles::append(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices) {
  const std::size_t n = polygon.size();
  Fan fan{0, true, false};
  if (n > 3) {
    const Vec3d area = any_area_vector(positions_, polygon);
    fan = find_fan(positions_, polygon, area);
    if (!fan.is_good && n > 4 && area != Vec3d(0.0) && append_triangulated(polygon, area, indices)) return;
    if (n == 4 && fan.is_folded) ++crossing_;  // each other diagonal was tried
  }
  append_fan(polygon, fan, indices);
}

void FaceTriangles::report(std::vector<LeftOut>& left_out) const {
  if (crossing_ != 0) {
    left_out.push_back({"the shape of " + counted(crossing_, "face"),
                        "their sides cross or touch each other, so that what is inside is a guess"});
  }
  if (bent_ != 0) {
    left_out.push_back({"the shape of " + counted(bent_, "bent face"),
                        "their triangles do not have all of their border, so that some of the surface is missing"});
  }
  if (too_large_ != 0) {
    left_out.push_back({"the shape of " + counted(too_large_, "dented face"),
                        "they have too many corners to be triangulated; triangles from one corner stand in"});
  }
}

}  // namespace meshlode::scene
