// SPDX-License-Identifier: MIT
// The camera of a caller's view, for the C++ and the C side: both views have the same fields.
#pragma once

#include <cmath>
#include <cstdint>

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

}  // namespace meshlode::run
