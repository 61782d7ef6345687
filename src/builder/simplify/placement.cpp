// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/placement.h"

#include <algorithm>

namespace meshlode::builder {

namespace {

/// The best point of the edge, then its ends: E along the edge is a parabola.
template <class Real>
Vec3d place_on_edge(const BasicQuadric<Real>& total, const Vec3d& pa, const Vec3d& pb) {
  using Vec = glm::vec<3, Real>;
  const Vec edge(pb - pa);
  const auto times = [&](const Vec& v) {
    return Vec(total.a00 * v.x + total.a01 * v.y + total.a02 * v.z, total.a01 * v.x + total.a11 * v.y + total.a12 * v.z,
               total.a02 * v.x + total.a12 * v.y + total.a22 * v.z);
  };
  const Real slope = glm::dot(edge, times(Vec(pa)) + Vec(total.b0, total.b1, total.b2));
  const Real bend = glm::dot(edge, times(edge));
  const Real t = bend > Real(0) ? std::clamp(-slope / bend, Real(0), Real(1)) : Real(0.5);
  Vec3d best = pa + (pb - pa) * double{t};
  Real best_error = total.evaluate(Vec(best));
  for (const Vec3d& end : {pa, pb}) {
    const Real error = total.evaluate(Vec(end));
    if (error < best_error) {
      best = end;
      best_error = error;
    }
  }
  return best;
}

}  // namespace

template <class Real>
Vec3d place_vertex(BasicQuadric<Real>& total, const Vec3d& pa, const Vec3d& pb, bool has_fallback) {
  using Vec = glm::vec<3, Real>;
  const Vec3d edge = pb - pa;
  const Vec3d middle = (pa + pb) * 0.5;
  Vec best;
  if (!has_fallback) return total.minimize(best, Real(0)) ? Vec3d(best) : middle;
  total.add_point(Vec(middle), static_cast<Real>(kPull) * total.weight);
  if (total.minimize(best)) {
    const Vec3d offset = Vec3d(best) - middle;
    if (glm::dot(offset, offset) <= kMaxOffset * kMaxOffset * glm::dot(edge, edge)) return Vec3d(best);
  }
  return place_on_edge(total, pa, pb);
}

template Vec3d place_vertex(BasicQuadric<double>&, const Vec3d&, const Vec3d&, bool);
template Vec3d place_vertex(BasicQuadric<float>&, const Vec3d&, const Vec3d&, bool);

}  // namespace meshlode::builder
