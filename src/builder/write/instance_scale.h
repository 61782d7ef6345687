// SPDX-License-Identifier: GPL-3.0-or-later
// How much an instance's transform enlarges spheres and errors at most, and whether it can be drawn.
#pragma once

#include <cstdint>

#include "base/vec.h"

namespace meshlode::builder {

struct InstanceScale {
  double largest = 0.0;     ///< at least the largest singular value of the 3×3 part; 0 where the matrix is not finite
  std::uint32_t flags = 0;  ///< format::kInstanceMirrored, kInstanceSingular
};

/// The exact value for axis-aligned scalings and permutations of axes, else within 1e-12 of it, rounded up.
[[nodiscard]] InstanceScale measure_instance(const Mat4d& transform);

}  // namespace meshlode::builder
