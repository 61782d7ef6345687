// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertex of a collapsed edge goes, and what the collapse costs there.
#pragma once

#include <cmath>

#include "base/vec.h"
#include "builder/simplify/quadric.h"

namespace meshlode::builder {

/// Weight of the pull towards the collapsed edge: places vertices sensibly where the surface is flat, and lets short
/// edges go first there. A share of the squared edge length, far below any deviation that matters.
inline constexpr double kPull = 1e-6;
/// How far from the edge's middle a new vertex may lie, in edge lengths.
inline constexpr double kMaxOffset = 1.5;

/// The cheapest place for the vertex of the edge from pa to pb; `total` is all that its place costs, and is given the
/// pull towards the edge's middle. Where the minimum cannot be trusted or lies too far off, the best point of the edge.
/// Without the fallback there is no pull, and any finite minimum is taken. `Real`: double or float.
template <class Real>
[[nodiscard]] Vec3d place_vertex(BasicQuadric<Real>& total, const Vec3d& pa, const Vec3d& pb, bool has_fallback = true);

/// E / √W at the place: E with what of it does not depend on the place, W the summed area, total.weight.
template <class Real>
[[nodiscard]] double cost_of_collapse(const BasicQuadric<Real>& total, const Vec3d& place, double fixed_error,
                                      double length2) {
  const double weight{total.weight};
  const double error = double{total.evaluate(place)} + fixed_error + kPull * weight * length2;
  return weight > 0.0 ? error / std::sqrt(weight) : error;
}

}  // namespace meshlode::builder
