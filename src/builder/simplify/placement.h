// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertex of a collapsed edge goes, and what the collapse costs there. Inline: half of the time goes here.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.h"
#include "builder/simplify/quadric.h"

namespace meshlode::builder {

/// Weight of the pull towards the collapsed edge: places vertices sensibly where the surface is flat, and lets short
/// edges go first there. A share of the squared edge length, far below any deviation that matters.
inline constexpr double kPull = 1e-6;
/// How far from the edge's middle a new vertex may lie, in edge lengths.
inline constexpr double kMaxOffset = 1.5;

[[nodiscard]] inline bool is_near_edge(const Vec3d& place, const Vec3d& pa, const Vec3d& pb) {
  const Vec3d offset = place - (pa + pb) * 0.5, edge = pb - pa;
  return glm::dot(offset, offset) <= kMaxOffset * kMaxOffset * glm::dot(edge, edge);
}

/// The best point of the edge, then its ends: E along the edge is a parabola.
template <class Real>
[[nodiscard]] Vec3d place_on_edge(const BasicQuadric<Real>& total, const Vec3d& pa, const Vec3d& pb) {
  using Vec = glm::vec<3, Real>;
  const Vec edge(pb - pa);
  const auto times = [&](const Vec& v) {
    return Vec(total.a00() * v.x + total.a01() * v.y + total.a02() * v.z,
               total.a01() * v.x + total.a11() * v.y + total.a12() * v.z,
               total.a02() * v.x + total.a12() * v.y + total.a22() * v.z);
  };
  const Real slope = glm::dot(edge, times(Vec(pa)) + Vec(total.b0(), total.b1(), total.b2()));
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

/// The cheapest place for the vertex of the edge from pa to pb; `total` is all that its place costs, and is given the
/// pull towards the edge's middle. Where the minimum cannot be trusted or lies too far off, the best point of the edge.
/// Without the fallback there is no pull, and any finite minimum is taken. `Real`: double or float.
template <class Real>
[[nodiscard]] Vec3d place_vertex(BasicQuadric<Real>& total, const Vec3d& pa, const Vec3d& pb,
                                 bool has_fallback = true) {
  using Vec = glm::vec<3, Real>;
  const Vec3d middle = (pa + pb) * 0.5;
  Vec best;
  if (!has_fallback) return total.minimize(best, Real(0)) ? Vec3d(best) : middle;
  total.add_point(Vec(middle), static_cast<Real>(kPull) * total.weight);
  if (total.minimize(best) && is_near_edge(Vec3d(best), pa, pb)) return Vec3d(best);
  return place_on_edge(total, pa, pb);
}

/// E / √W at the place: E with what of it does not depend on the place, W the summed area, total.weight.
template <class Real>
[[nodiscard]] double cost_of_collapse(const BasicQuadric<Real>& total, const Vec3d& place, double fixed_error,
                                      double length2) {
  const double weight{total.weight};
  const double error = std::max(0.0, double{total.evaluate(place)} + fixed_error) + kPull * weight * length2;
  return weight > 0.0 ? error / std::sqrt(weight) : error;
}

}  // namespace meshlode::builder
