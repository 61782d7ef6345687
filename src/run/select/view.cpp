// SPDX-License-Identifier: MIT
// From a camera and an instance, in doubles, to the floats of MetricView. Everything here happens once per instance, so
// its rounding is the same for every group; docs/reference/selection.md says why each bound is rounded the way it is.
#include <algorithm>
#include <cmath>

#include "base/float_above.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

constexpr double kGrowth = 1.0 + 0x1p-20;  // over the rounding of the rows (sqrt(3)·2^-24) and of the formula
constexpr double kMinNear = 0x1p-40;
constexpr double kMaxNear = 0x1p61;  // below METRIC_ERROR_CAP: a capped error never passes by the near distance
constexpr double kMaxFactor = 0x1p126;
constexpr double kMinFactor = 0x1p-126;  // the smallest normal float
constexpr int kScaledExponent = 30;      // the largest scaled length lies in [2^29, 2^30)

// NaN becomes `high`: an error scale that makes no sense lets nothing pass but errors of 0.
double clamp_or_high(double value, double low, double high) {
  return value < high ? std::max(value, low) : high;
}

// A power of two that brings the instance's lengths to about 2^30.
double choose_unit(double largest_length, double sigma) {
  if (!(largest_length > 0.0) || !std::isfinite(largest_length)) return 1.0;
  int exponent = 0;
  std::frexp(largest_length, &exponent);
  int unit = kScaledExponent - exponent;
  if (sigma > 0.0 && std::isfinite(sigma)) {
    int sigma_exponent = 0;
    std::frexp(sigma, &sigma_exponent);
    unit = std::min(unit, 100 - sigma_exponent);  // rows stay far from overflow, at mesh sizes below 1e-21
  }
  return std::ldexp(1.0, std::clamp(unit, -1000, 1000));
}

}  // namespace

double mesh_reach(const SelectTables& tables, const format::MeshRecord& mesh) {
  if (mesh.node_count == 0) return 0.0;
  const format::NodeRecord& root = tables.nodes[mesh.first_node];
  const double x = root.center[0], y = root.center[1], z = root.center[2];
  return std::sqrt(x * x + y * y + z * z) + root.radius;
}

MetricView make_metric_view(const Camera& camera, double pixel_error, const format::InstanceRecord& instance,
                            const format::MeshRecord& mesh, double reach) {
  const double sigma = instance.scale;
  const double height = camera.height;
  // Pixels per world unit at distance 1 (perspective) or anywhere (orthographic), over the allowed pixels.
  const double pixels =
      camera.is_orthographic ? height / camera.ortho_height : height / (2.0 * std::tan(0.5 * camera.fovy));
  MetricView view{};
  if (!(pixel_error > 0.0)) {
    view.error_scale = static_cast<float>(kMaxFactor);  // any normal error is scaled to 1 at least
    view.near_distance = static_cast<float>(kMinNear);
    return view;
  }
  // Divided once per camera: a GPU makes these views by the million, and only + and * are exact there.
  const double pixels_per_error = pixels / pixel_error;
  if (camera.is_orthographic) {
    // The rows and the scale stay 0: E <= 1 decides alone, since a larger E has a square above 0.
    view.error_scale = float_above(clamp_or_high(sigma * pixels_per_error * kGrowth, kMinFactor, kMaxFactor));
    view.near_distance = 1.0F;
    return view;
  }
  const double* m = instance.transform;
  const double* o = mesh.origin;
  const double eye[3] = {camera.eye.x, camera.eye.y, camera.eye.z};
  double translation[3];
  for (int i = 0; i < 3; ++i) {
    const double* row = m + 4 * i;
    translation[i] = ((row[0] * o[0] + row[1] * o[1]) + row[2] * o[2]) + (row[3] - eye[i]);
  }
  const double distance =
      std::sqrt(translation[0] * translation[0] + translation[1] * translation[1] + translation[2] * translation[2]);
  const double unit = choose_unit(std::max(sigma * reach, distance), sigma);
  MetricVec4* rows[3] = {&view.row0, &view.row1, &view.row2};
  for (int i = 0; i < 3; ++i) {
    const double* row = m + 4 * i;
    *rows[i] = {static_cast<float>(row[0] * unit), static_cast<float>(row[1] * unit), static_cast<float>(row[2] * unit),
                static_cast<float>(translation[i] * unit)};
  }
  view.scale = float_above(clamp_or_high(sigma * unit * kGrowth, 0.0, kMaxFactor));
  view.error_scale = float_above(clamp_or_high(sigma * pixels_per_error * unit * kGrowth, kMinFactor, kMaxFactor));
  view.near_distance = static_cast<float>(clamp_or_high(camera.near_distance * unit, kMinNear, kMaxNear));
  return view;
}

}  // namespace meshlode::run
