// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded randomness with the same numbers on every C++ library (std:: distributions differ between them).
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"

namespace meshlode::test {

class RandomSource {  // splitmix64 (Steele, Lea and Flood 2014)
 public:
  explicit RandomSource(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(next() % n); }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }            ///< [0, 1)
  double between(double low, double high) { return low + (high - low) * unit(); }
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool chance(double p) { return unit() < p; }
  Vec3d in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3d direction() {
    for (;;) {
      const Vec3d v = in_cube(1.0);
      const double length = glm::length(v);
      if (length > 0.01 && length <= 1.0) return v / length;
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace meshlode::test
