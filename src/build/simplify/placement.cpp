// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/simplify/placement.h"

#include <algorithm>

namespace meshlode::build {

namespace {

/// The best point of the edge, then its ends: E along the edge is a parabola.
Vec3d place_on_edge(const Quadric& total, const Vec3d& pa, const Vec3d& pb) {
  const Vec3d edge = pb - pa;
  const auto times = [&](const Vec3d& v) {
    return Vec3d(total.a00 * v.x + total.a01 * v.y + total.a02 * v.z,
                 total.a01 * v.x + total.a11 * v.y + total.a12 * v.z,
                 total.a02 * v.x + total.a12 * v.y + total.a22 * v.z);
  };
  const double slope = glm::dot(edge, times(pa) + Vec3d(total.b0, total.b1, total.b2));
  const double bend = glm::dot(edge, times(edge));
  const double t = bend > 0.0 ? std::clamp(-slope / bend, 0.0, 1.0) : 0.5;
  Vec3d best = pa + edge * t;
  double best_error = total.evaluate(best);
  for (const Vec3d& end : {pa, pb}) {
    const double error = total.evaluate(end);
    if (error < best_error) {
      best = end;
      best_error = error;
    }
  }
  return best;
}

}  // namespace

Vec3d place_vertex(Quadric& total, const Vec3d& pa, const Vec3d& pb) {
  const Vec3d edge = pb - pa;
  const Vec3d middle = (pa + pb) * 0.5;
  total.add_point(middle, kPull * total.weight);
  Vec3d best;
  if (total.minimize(best)) {
    const Vec3d offset = best - middle;
    if (glm::dot(offset, offset) <= kMaxOffset * kMaxOffset * glm::dot(edge, edge)) return best;
  }
  return place_on_edge(total, pa, pb);
}

}  // namespace meshlode::build
