// SPDX-License-Identifier: MIT
// What metric.h asks of the stored floats so that `coarser passes` implies `finer passes` for every camera, in float
// arithmetic (I4 => I5). The proof is in docs/reference/selection.md; u = 2^-24 is half an ulp, relative.
#pragma once

#include <cmath>

#include <meshlode/format.h>

#include "base/float_above.h"

namespace meshlode::run {

/// Relative part: both radii may be off by this much.
constexpr double kNestingRadiusMargin = 6.0 / 16777216.0;  // 6u; the proof needs 5.1u
/// Absolute part: relative to the centres' distances from the mesh's origin (rounding of M·c).
constexpr double kNestingCenterMargin = 6.0 / 16777216.0;  // 6u; the proof needs 5.2u
/// A coarser error is at least (1 + this) times a finer one, or both are 0.
constexpr double kNestingErrorMargin = 12.0 / 16777216.0;  // 12u; the proof needs 10.3u

/// What a bound that is made from stored ones grows by; the builder's own growth from a finer error to a coarser one.
constexpr double kNestingErrorGrowth = 0x1p-18;  // 64u

struct StoredBound {
  float center[3];
  float radius;
  float error;
};

[[nodiscard]] inline StoredBound bound_of(const format::GroupRecord& group) {
  return {{group.center[0], group.center[1], group.center[2]}, group.radius, group.error};
}
[[nodiscard]] inline StoredBound bound_of(const format::NodeRecord& node) {
  return {{node.center[0], node.center[1], node.center[2]}, node.radius, node.error};
}

/// How much of the outer radius is left, in object units, after the inner sphere and the margins: negative = not
/// nested. Doubles carry it: their rounding is 2^-29 of the margin itself. NaN where an input is not finite.
[[nodiscard]] inline double nesting_slack(const StoredBound& outer, const StoredBound& inner) {
  const auto norm = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); };
  const double ox = outer.center[0], oy = outer.center[1], oz = outer.center[2];
  const double ix = inner.center[0], iy = inner.center[1], iz = inner.center[2];
  const double needed = norm(ox - ix, oy - iy, oz - iz) + inner.radius * (1.0 + kNestingRadiusMargin) +
                        kNestingCenterMargin * (norm(ox, oy, oz) + norm(ix, iy, iz));
  return outer.radius * (1.0 - kNestingRadiusMargin) - needed;
}

[[nodiscard]] inline bool is_sphere_nested(const StoredBound& outer, const StoredBound& inner) {
  return nesting_slack(outer, inner) >= 0.0;
}

/// Errors of two bounds along the DAG or the BVH. Errors are 0 or normal floats.
[[nodiscard]] inline bool is_error_nested(float outer, float inner) {
  if (!(inner >= 0.0F) || !(outer >= 0.0F)) return false;
  if (outer >= format::kInfiniteError) return true;
  if (inner == 0.0F) return true;
  return double{outer} >= double{inner} * (1.0 + kNestingErrorMargin);
}

/// The smallest float above `inner` by the growth: an error that is nested over it and over every smaller one. 0 stays
/// 0, since errors of 0 pass for every camera; infinite where no finite float is above. \pre not negative, not NaN
[[nodiscard]] inline float coarser_error(float inner) {
  return float_above(double{inner} * (1.0 + kNestingErrorGrowth));
}

/// \pre for bounds that are not the same bits: a sphere is not nested in itself, though its rule agrees with itself.
[[nodiscard]] inline bool is_nested(const StoredBound& outer, const StoredBound& inner) {
  return is_error_nested(outer.error, inner.error) && is_sphere_nested(outer, inner);
}

}  // namespace meshlode::run
