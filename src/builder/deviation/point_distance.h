// SPDX-License-Identifier: GPL-3.0-or-later
// Distance from a point to one triangle in doubles: the numbers that are stored come from here alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/vec.h"

namespace meshlode::builder {

using TriangleCorners = std::array<Vec3d, 3>;

[[nodiscard]] inline double longest_edge(const TriangleCorners& c) {
  const Vec3d ab = c[1] - c[0], bc = c[2] - c[1], ca = c[0] - c[2];
  return std::sqrt(std::max(glm::dot(ab, ab), std::max(glm::dot(bc, bc), glm::dot(ca, ca))));
}

/// `length2`: of the edge, squared.
[[nodiscard]] inline double point_segment_distance2(const Vec3d& pa, const Vec3d& edge, double length2) {
  const double along = glm::dot(pa, edge);
  const double t = along > 0.0 && length2 > 0.0 ? std::min(along / length2, 1.0) : 0.0;
  const Vec3d away = pa - edge * t;
  return glm::dot(away, away);
}
[[nodiscard]] inline double point_segment_distance2(const Vec3d& pa, const Vec3d& edge) {
  return point_segment_distance2(pa, edge, glm::dot(edge, edge));
}

/// A triangle that several points are asked of: what does not depend on them is worked out once.
class TriangleDistance {
 public:
  explicit TriangleDistance(const TriangleCorners& corners)
      : a_(corners[0]),
        b_(corners[1]),
        ab_(corners[1] - corners[0]),
        ac_(corners[2] - corners[0]),
        bc_(corners[2] - corners[1]),
        n_(glm::cross(ab_, ac_)),
        nn_(glm::dot(n_, n_)),
        ab2_(glm::dot(ab_, ab_)),
        ac2_(glm::dot(ac_, ac_)),
        bc2_(glm::dot(bc_, bc_)) {
    const double longest2 = std::max(ab2_, std::max(ac2_, bc2_));
    // Twice the area against the longest edge: a sine. Below 1e-5 the normal begins to feel the rounding, and the
    // inside is that close to the edges anyway.
    has_inside_ = nn_ > 1e-10 * longest2 * longest2;
  }

  /// As point_triangle_distance2().
  [[nodiscard]] double squared_to(const Vec3d& p) const {
    const Vec3d pa = p - a_;
    if (has_inside_) {
      const double v = glm::dot(glm::cross(pa, ac_), n_) / nn_;
      const double w = glm::dot(glm::cross(ab_, pa), n_) / nn_;
      if (v >= 0.0 && w >= 0.0 && w <= 1.0 - v) {
        const Vec3d away = pa - ab_ * v - ac_ * w;
        return glm::dot(away, away);
      }
    }
    return std::min(point_segment_distance2(pa, ab_, ab2_),
                    std::min(point_segment_distance2(pa, ac_, ac2_), point_segment_distance2(p - b_, bc_, bc2_)));
  }

  /// False for a needle, a segment or a point: what is nearest lies on an edge then.
  [[nodiscard]] bool has_inside() const { return has_inside_; }

 private:
  Vec3d a_, b_, ab_, ac_, bc_, n_;
  double nn_, ab2_, ac2_, bc2_;
  bool has_inside_;
};

/// Squared distance. The triangle may be a needle, a segment or a point. Whatever is returned is the distance to a
/// point of the triangle that was worked out, so that an ill-conditioned triangle makes it larger than need be, never
/// smaller: with u = 2^-53, d what is returned and L the longest edge, the true distance is at most √d² · (1 + 8u) + 9u
/// · L. (Weights are at least 0 and add up to 1 + u at most: the point misses the triangle by u · L. Differences are
/// exact but for u each; pa, the two products and the two subtractions lose 2|pa| + 5L + √d² times u, where |pa| <= √d²
/// + L; and the sum of squares 3u of d².) Tested against exact arithmetic.
[[nodiscard]] inline double point_triangle_distance2(const Vec3d& p, const TriangleCorners& corners) {
  return TriangleDistance(corners).squared_to(p);
}

/// What of a triangle is nearest to a point: its inside (never of one that has none), or an edge (k: from corner k to
/// the next) or a corner.
struct NearestFeature {
  enum class Kind : std::uint8_t { kInside, kEdge, kCorner };
  Kind kind = Kind::kInside;
  std::size_t index = 0;
};

[[nodiscard]] inline NearestFeature nearest_feature(const Vec3d& p, const TriangleCorners& corners) {
  const TriangleDistance triangle(corners);
  double distance2 = triangle.squared_to(p);
  if (!triangle.has_inside()) {  // the same edges from their other ends are off by another rounding, and one it is
    distance2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      distance2 = std::min(distance2, point_segment_distance2(p - corners[k], corners[(k + 1) % 3] - corners[k]));
    }
  }
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

/// Where on the triangle that is; of a needle, a segment or a point too.
[[nodiscard]] inline Vec3d nearest_point(const Vec3d& p, const TriangleCorners& corners) {
  const NearestFeature feature = nearest_feature(p, corners);
  const Vec3d& a = corners[feature.index];
  if (feature.kind == NearestFeature::Kind::kCorner) return a;
  if (feature.kind == NearestFeature::Kind::kEdge) {
    const Vec3d edge = corners[(feature.index + 1) % 3] - a;
    return a + edge * std::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
  }
  const Vec3d normal = glm::cross(corners[1] - a, corners[2] - a);
  return p - normal * (glm::dot(p - a, normal) / glm::dot(normal, normal));
}

}  // namespace meshlode::builder
