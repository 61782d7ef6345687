// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers that are the same everywhere: random numbers, sines and noise without a math library (I10).
#pragma once

#include <cstdint>

#include "base/vec.h"

namespace meshlode::scene {

/// splitmix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }  ///< in [0, 1)
  double range(double low, double high) { return low + (high - low) * unit(); }
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>((next() >> 32) * count >> 32); }

 private:
  std::uint64_t state_;
};

/// Sine and cosine of an angle in whole turns (1 = 360 degrees): Taylor series on an eighth of a turn, error below
/// 1e-15. Quarter turns are exact.
[[nodiscard]] double sin_turns(double turns);
[[nodiscard]] double cos_turns(double turns);

/// Smooth noise in [-1, 1] on the unit lattice, and its sum over `octaves` of halving size and strength.
[[nodiscard]] double value_noise(const Vec3d& p, std::uint64_t seed);
[[nodiscard]] double fractal_noise(const Vec3d& p, std::uint32_t octaves, std::uint64_t seed);

}  // namespace meshlode::scene
