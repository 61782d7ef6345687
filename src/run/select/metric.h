// SPDX-License-Identifier: MIT
// The selection rule, once: this text is compiled as C++ and as GLSL (I9). docs/reference/selection.md derives it and
// its margins.
//
// A group *passes* for a view iff drawing what is coarser than its members moves nothing by more than the allowed
// pixels:
//     error · sigma · k <= t · max(|M·center - eye| - radius · sigma, near)
// With F = sigma · k / t folded into one factor this is, without division or square root,
//     E <= near   or   (E + R)^2 <= |M·center - eye|^2      with E = error · F, R = radius · sigma.
//
// What makes it the same on every machine, and monotone in the floats as they are (I4 => I5):
//  - only float +, -, * and comparisons, in this order; C++ is built with -ffp-contract=off, GLSL says `precise`;
//  - the view is scaled by a power of two so that lengths lie below 2^31 and near is at least 2^-40: a denormal is then
//    never more than a neglected addend, flushed or not; nothing overflows, because E is capped;
//  - all that depends on the camera and instance is rounded once, into MetricView, and shared by every group.
#ifndef MESHLODE_SELECT_METRIC_H
#define MESHLODE_SELECT_METRIC_H

#ifdef __cplusplus
namespace meshlode::run {
struct MetricVec4 {
  float x, y, z, w;
};
#define METRIC_FUNCTION [[nodiscard]] inline
#define METRIC_VALUE const float
#else
#define MetricVec4 vec4
#define METRIC_FUNCTION
#define METRIC_VALUE precise float
#endif

#define METRIC_INFINITE_ERROR 3.402823466e+38f  /* format::kInfiniteError: a terminal group never passes */
#define METRIC_ERROR_CAP 4611686018427387904.0f /* 2^62: above every scaled distance, and its square is finite */

// One instance seen by one camera, in the instance's own power-of-two units. 64 bytes, std430.
struct MetricView {
  MetricVec4 row0;  // xyz: a row of the 3x3 part of mesh space -> world; w: the translation relative to the eye
  MetricVec4 row1;
  MetricVec4 row2;
  float scale;          // at least the largest singular value of the rows as they are stored here
  float error_scale;    // F: from an error in object units to the distance at which it covers the allowed pixels
  float near_distance;  // 2^-40 ... 2^61
  float reserved;
};

METRIC_FUNCTION bool metric_passes(MetricView view, float center_x, float center_y, float center_z, float radius,
                                   float error) {
  if (!(error < METRIC_INFINITE_ERROR)) return false;
  METRIC_VALUE scaled_error = error * view.error_scale;
  METRIC_VALUE e = scaled_error < METRIC_ERROR_CAP ? scaled_error : METRIC_ERROR_CAP;
  if (e <= view.near_distance) return true;
  METRIC_VALUE r = radius * view.scale;
  METRIC_VALUE reach = e + r;
  METRIC_VALUE x = ((view.row0.x * center_x + view.row0.y * center_y) + view.row0.z * center_z) + view.row0.w;
  METRIC_VALUE y = ((view.row1.x * center_x + view.row1.y * center_y) + view.row1.z * center_z) + view.row1.w;
  METRIC_VALUE z = ((view.row2.x * center_x + view.row2.y * center_y) + view.row2.z * center_z) + view.row2.w;
  METRIC_VALUE distance2 = (x * x + y * y) + z * z;
  METRIC_VALUE reach2 = reach * reach;
  return reach2 <= distance2;
}

#undef METRIC_FUNCTION
#undef METRIC_VALUE
#ifdef __cplusplus
static_assert(sizeof(MetricView) == 64);
}  // namespace meshlode::run
#endif

#endif  // MESHLODE_SELECT_METRIC_H
