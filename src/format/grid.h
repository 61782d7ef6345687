// SPDX-License-Identifier: MIT
// The grid of a mesh: position = origin + step · q with step = mantissa · 2^log2 (docs/reference/format.md, section 4).
// Rounding is floor(x · s + 0.5), never a truncation: truncation rounds negative coordinates the wrong way.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"

namespace meshlode::format {

/// 2^exponent, exact. \pre -1022 <= exponent <= 1023
[[nodiscard]] inline double exp2_exact(int exponent) {
  return std::ldexp(1.0, exponent);
}

struct PositionGrid {
  int log2 = 0;
  std::uint32_t mantissa = 1;

  [[nodiscard]] double step() const { return exp2_exact(log2) * mantissa; }
  /// Nearest grid point of a position relative to the mesh's origin.
  [[nodiscard]] Vec3i quantize(const Vec3d& p) const {
    const double s = step();
    return {static_cast<int>(std::floor(p.x / s + 0.5)), static_cast<int>(std::floor(p.y / s + 0.5)),
            static_cast<int>(std::floor(p.z / s + 0.5))};
  }
  [[nodiscard]] Vec3d decode(const Vec3i& q) const { return Vec3d(q) * step(); }
};

/// Largest |q| on a grid: float decode stays exact below 2^24.
constexpr int kMaxGridCoordinate = (1 << 23) - 1;

}  // namespace meshlode::format
