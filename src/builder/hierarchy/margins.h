// SPDX-License-Identifier: GPL-3.0-or-later
// The margins with which stored bounds nest, and the roundings that keep them (I4). They are a little larger than what
// the selection rule needs (run/read/nesting.h; docs/reference/selection.md has the proof), so that a judge with other
// rounding of its own agrees. u = 2^-24.
#pragma once

#include <cmath>
#include <cstdint>

#include <meshlode/format.h>

#include "base/float_above.h"
#include "base/vec.h"
#include "builder/hierarchy/hierarchy.h"

namespace meshlode::builder {

constexpr double kSphereGrowth = 0x1p-21;     ///< 8u, of both radii
constexpr double kCenterGrowth = 0x1p-21;     ///< 8u, of both centres' distances from the origin
constexpr double kErrorGrowth = 0x1p-18;      ///< 64u, from a finer error to a coarser one
constexpr double kDoubleSlack = 0x1p-48;      ///< more than the rounding of the double formulas here
constexpr float kMinStoredError = 0x1p-100F;  ///< smaller errors are raised to it: no decision rests on a denormal
constexpr float kMaxStoredError = 0x1p120F;   ///< larger finite errors are lowered to it, to stay below infinite

/// sqrt(x·x + y·y + z·z) in one order of operations.
[[nodiscard]] inline double length_of(const Vec3d& v) {
  return std::sqrt((v.x * v.x + v.y * v.y) + v.z * v.z);
}

[[nodiscard]] inline Vec3d center_of(const Hierarchy::Sphere& s) {
  return {s.center[0], s.center[1], s.center[2]};
}

/// The radius that a sphere around `center` needs for `inner` to nest in it with the margins, before rounding up.
[[nodiscard]] inline double nesting_radius(const Vec3d& center, const Hierarchy::Sphere& inner) {
  const Vec3d c = center_of(inner);
  const double needed =
      length_of(center - c) + inner.radius * (1.0 + kSphereGrowth) + kCenterGrowth * (length_of(center) + length_of(c));
  return needed / (1.0 - kSphereGrowth) * (1.0 + kDoubleSlack);
}

}  // namespace meshlode::builder
