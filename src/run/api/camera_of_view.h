// SPDX-License-Identifier: MIT
// The camera of a caller's view, for the C++ and the C side: both views have the same fields.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "run/api/by_promise.h"
#include "run/select/frustum.h"
#include "run/select/select.h"

namespace meshlode::run {

/// What is wrong with a view; `field` is null where nothing is.
struct ViewFault {
  const char* field = nullptr;
  const char* detail = nullptr;
};

template <class View>
ViewFault fault_of_view(const View& view) {
  const auto is_positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  constexpr double kPi = 3.14159265358979323846;
  for (const double c : view.eye) {
    if (!std::isfinite(c)) return {"eye", "is not finite"};
  }
  if (view.height_px == 0) return {"height_px", "is 0"};
  if (!is_positive(view.near_distance)) return {"near_distance", "is not above 0"};
  if (static_cast<bool>(view.is_orthographic)) {
    if (!is_positive(view.ortho_height)) return {"ortho_height", "is not above 0"};
  } else if (!(view.fovy_radians > 0.0 && view.fovy_radians < kPi)) {
    return {"fovy_radians", "is not between 0 and pi"};
  }
  if (static_cast<std::uint32_t>(view.promise) >= kPromiseCount) return {"promise", kPromiseFault};
  return {};
}

/// Of a view without fault.
template <class View>
Camera camera_of_view(const View& view) {
  Camera camera;
  camera.eye = {view.eye[0], view.eye[1], view.eye[2]};
  camera.target = camera.eye - Vec3d(0.0, 0.0, 1.0);  // any direction: the rule does not look at it
  camera.is_orthographic = static_cast<bool>(view.is_orthographic);
  camera.fovy = view.fovy_radians;
  camera.ortho_height = view.ortho_height;
  camera.near_distance = view.near_distance;
  camera.height = view.height_px;
  camera.width = view.height_px;
  return camera;
}

constexpr const char* kFrustumFault = "target, up and aspect do not make a picture";

/// Nothing where there is no picture: numbers that are not finite, a target at the eye, an up that is parallel.
inline std::optional<Frustum> frustum_of_view(const Camera& camera, const double target[3], const double up[3],
                                              double aspect) {
  FrustumShape shape;
  // Of any length, with the largest entry 1: NaN where there is none.
  const auto scaled = [](const Vec3d& v) { return v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  shape.eye = camera.eye;
  shape.forward = scaled(Vec3d(target[0], target[1], target[2]) - camera.eye);
  shape.up = scaled({up[0], up[1], up[2]});
  shape.is_orthographic = camera.is_orthographic;
  shape.half_height = camera.is_orthographic ? 0.5 * camera.ortho_height : std::tan(0.5 * camera.fovy);
  shape.aspect = aspect;
  const Vec3d side = glm::cross(shape.forward, shape.up);
  if (!(aspect > 0.0) || !(glm::dot(side, side) > 1e-18)) return std::nullopt;
  const Frustum frustum = make_frustum(shape);
  for (const auto& plane : frustum.planes) {
    for (const double value : plane) {
      if (!std::isfinite(value)) return std::nullopt;
    }
  }
  return frustum;
}

}  // namespace meshlode::run
