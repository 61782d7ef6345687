// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that are the same everywhere: sines and noise without a math library (I10); base/random.h has random ones.
#pragma once

#include <cstdint>

#include "base/vec.h"

namespace meshlode::lab {

/// Sine and cosine of an angle in whole turns (1 = 360 degrees): Taylor series on an eighth of a turn, error below
/// 1e-15. Quarter turns are exact.
[[nodiscard]] double sin_turns(double turns);
[[nodiscard]] double cos_turns(double turns);

/// Smooth noise in [-1, 1] on the unit lattice, and its sum over `octaves` of halving size and strength.
[[nodiscard]] double value_noise(const Vec3d& p, std::uint64_t seed);
[[nodiscard]] double fractal_noise(const Vec3d& p, std::uint32_t octaves, std::uint64_t seed);

}  // namespace meshlode::lab
