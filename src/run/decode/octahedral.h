// SPDX-License-Identifier: MIT
// Octahedral normals: an integer point of |X| + |Y| + |Z| = M, whose direction is the normal, is stored as two integers
// in one of six charts.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

#include "base/vec.h"

namespace meshlode::run {

/// The integer point of stored values a and b (docs/reference/format.md, Normals). Integer arithmetic only, so it is
/// the same everywhere (I9). \pre a and b below 2^15, chart below 6
[[nodiscard]] inline std::array<std::int32_t, 3> octahedral_point(std::int32_t a, std::int32_t b, std::uint32_t chart,
                                                                  std::int32_t scale) {
  std::int32_t x = a - scale;
  std::int32_t y = b - scale;
  std::int32_t z = scale - std::abs(x) - std::abs(y);
  if (z < 0) {
    const std::int32_t folded = x < 0 ? std::abs(y) - scale : scale - std::abs(y);
    y = y < 0 ? std::abs(x) - scale : scale - std::abs(x);
    x = folded;
  }
  if (chart % 2 != 0) z = -z;
  switch (chart / 2) {
    case 0: return {z, x, y};
    case 1: return {y, z, x};
    default: return {x, y, z};
  }
}

/// The unit normal: each coordinate divided by the square root of the sum of squares, in double, rounded to float once.
[[nodiscard]] Vec3f octahedral_normal(const std::array<std::int32_t, 3>& point);

}  // namespace meshlode::run
