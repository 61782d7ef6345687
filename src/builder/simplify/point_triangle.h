// SPDX-License-Identifier: GPL-3.0-or-later
// Squared distance from a point to a triangle, by regions of its plane (Ericson 2005, 5.1.5). Triangles without area
// are handled as the segments or points that they are.
#pragma once

#include "base/vec.h"

namespace meshlode::builder {

/// A triangle that several points are asked of.
struct Facet {
  Vec3d a, b, c;
  Vec3d ab, ac;  ///< from a

  Facet(const Vec3d& at_a, const Vec3d& at_b, const Vec3d& at_c)
      : a(at_a), b(at_b), c(at_c), ab(at_b - at_a), ac(at_c - at_a) {}
};

[[nodiscard]] inline double distance2_to_facet(const Vec3d& p, const Facet& facet) {
  const auto& [a, b, c, ab, ac] = facet;
  const auto distance2 = [&p](const Vec3d& q) { return glm::dot(p - q, p - q); };
  const Vec3d ap = p - a;
  const double d1 = glm::dot(ab, ap);
  const double d2 = glm::dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return distance2(a);
  const Vec3d bp = p - b;
  const double d3 = glm::dot(ab, bp);
  const double d4 = glm::dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return distance2(b);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 - d3 > 0.0) return distance2(a + ab * (d1 / (d1 - d3)));
  const Vec3d cp = p - c;
  const double d5 = glm::dot(ab, cp);
  const double d6 = glm::dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return distance2(c);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 - d6 > 0.0) return distance2(a + ac * (d2 / (d2 - d6)));
  const double va = d3 * d6 - d5 * d4;
  const double along = (d4 - d3) + (d5 - d6);
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 && along > 0.0) return distance2(b + (c - b) * ((d4 - d3) / along));
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return distance2(a);
  return distance2(a + ab * (vb / sum) + ac * (vc / sum));
}

[[nodiscard]] inline double distance2_to_facet(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return distance2_to_facet(p, Facet(a, b, c));
}

}  // namespace meshlode::builder
