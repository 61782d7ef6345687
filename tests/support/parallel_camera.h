// SPDX-License-Identifier: GPL-3.0-or-later
// An orthographic camera along -z, for pictures whose pixels are known in closed form.
#pragma once

#include "run/select/select.h"

namespace meshlode::test {

/// Looks at `target` from `distance` in front of it; the picture is `units_high` units high.
inline run::Camera parallel_camera(const Vec3d& target, double distance, double units_high, std::uint32_t width,
                                   std::uint32_t height) {
  run::Camera camera;
  camera.eye = target + Vec3d(0.0, 0.0, distance);
  camera.target = target;
  camera.is_orthographic = true;
  camera.ortho_height = units_high;
  camera.width = width;
  camera.height = height;
  return camera;
}

}  // namespace meshlode::test
