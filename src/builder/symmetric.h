// SPDX-License-Identifier: GPL-3.0-or-later
// Axes of symmetric matrices of 3 × 3: second moments of pieces. With + - * / and sqrt alone (I10).
#pragma once

#include <array>
#include <utility>

#include "base/vec.h"

namespace meshlode::builder {

struct Axes {
  std::array<Vec3d, 3> direction;  ///< unit, right-handed, by falling value
  std::array<double, 3> value{};
};

/// Cyclic Jacobi, a fixed number of sweeps. \pre `m` is symmetric and finite
[[nodiscard]] Axes axes_of(Mat3d m);

/// a · bᵀ
[[nodiscard]] inline Mat3d outer(const Vec3d& a, const Vec3d& b) {
  return {a * b.x, a * b.y, a * b.z};
}

}  // namespace meshlode::builder
