// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "base/vec.h"

namespace meshlode::builder {

/// The unit normal of a triangle; of one without area zero: as far from every unit vector.
[[nodiscard]] inline Vec3d flat_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = glm::cross(b - a, c - a);
  const double length = std::sqrt(glm::dot(n, n));
  return length > 0.0 && std::isfinite(length) ? n / length : Vec3d(0.0);
}

}  // namespace meshlode::builder
