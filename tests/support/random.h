// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded numbers for tests: base/random.h, and directions.
#pragma once

#include <cstdint>

#include "base/random.h"
#include "base/vec.h"

namespace meshlode::test {

using Random = SplitMix64;

class RandomSource : public SplitMix64 {
 public:
  using SplitMix64::SplitMix64;
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(SplitMix64::below(n)); }
  Vec3d in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d v = in_cube(1.0);
      const double length = glm::length(v);
      if (length > 0.01 && length <= 1.0) return v / length;
    }
  }
};

}  // namespace meshlode::test
