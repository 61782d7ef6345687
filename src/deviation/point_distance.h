// SPDX-License-Identifier: GPL-3.0-or-later
// Distance from a point to one triangle in doubles: the numbers that are stored come from here alone.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "base/vec.h"

namespace meshlode {

using TriangleCorners = std::array<Vec3d, 3>;

[[nodiscard]] inline double point_segment_distance2(const Vec3d& pa, const Vec3d& edge) {
  const double length2 = glm::dot(edge, edge);
  const double along = glm::dot(pa, edge);
  const double t = along > 0.0 && length2 > 0.0 ? std::min(along / length2, 1.0) : 0.0;
  const Vec3d away = pa - edge * t;
  return glm::dot(away, away);
}

/// Squared distance. The triangle may be a needle, a segment or a point: an inside that rounding could have invented is
/// not trusted, and the edges, which are points of the triangle, answer instead. So the result is never too small by
/// more than rounding.
[[nodiscard]] inline double point_triangle_distance2(const Vec3d& p, const TriangleCorners& corners) {
  const Vec3d ab = corners[1] - corners[0];
  const Vec3d ac = corners[2] - corners[0];
  const Vec3d bc = corners[2] - corners[1];
  const Vec3d pa = p - corners[0];
  const Vec3d n = glm::cross(ab, ac);
  const double nn = glm::dot(n, n);
  const double longest2 = std::max(glm::dot(ab, ab), std::max(glm::dot(ac, ac), glm::dot(bc, bc)));
  // Twice the area against the longest edge: a sine. Below 1e-5 the normal begins to feel the rounding, and the inside
  // is that close to the edges anyway.
  if (nn > 1e-10 * longest2 * longest2) {
    const double u = glm::dot(glm::cross(ab, pa), n);
    const double v = glm::dot(glm::cross(pa, ac), n);
    if (u >= 0.0 && v >= 0.0 && glm::dot(glm::cross(bc, p - corners[1]), n) >= 0.0) {
      const double height = glm::dot(pa, n);
      return height * height / nn;
    }
  }
  return std::min(point_segment_distance2(pa, ab),
                  std::min(point_segment_distance2(pa, ac), point_segment_distance2(p - corners[1], bc)));
}

/// What of a triangle is nearest to a point: its inside, or an edge (k: from corner k to the next) or a corner.
struct NearestFeature {
  enum class Kind : std::uint8_t { kInside, kEdge, kCorner };
  Kind kind = Kind::kInside;
  std::size_t index = 0;
};

[[nodiscard]] inline NearestFeature nearest_feature(const Vec3d& p, const TriangleCorners& corners) {
  const double distance2 = point_triangle_distance2(p, corners);
  NearestFeature feature;
  double best2 = distance2 * (1.0 + 1e-9);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d edge = corners[(k + 1) % 3] - corners[k], pa = p - corners[k];
    const double edge2 = point_segment_distance2(pa, edge);
    if (!(edge2 <= best2)) continue;
    const double along = glm::dot(pa, edge);
    if (!(along > 0.0)) return {NearestFeature::Kind::kCorner, k};
    if (!(along < glm::dot(edge, edge))) return {NearestFeature::Kind::kCorner, (k + 1) % 3};
    feature = {NearestFeature::Kind::kEdge, k};
    best2 = edge2;
  }
  return feature;
}

}  // namespace meshlode
