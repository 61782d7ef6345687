// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded random numbers, the same everywhere (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number
// Generators").
#pragma once

#include <cmath>
#include <cstdint>

namespace meshlode::judge {

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// In [0, bound). \pre bound > 0
  std::uint64_t below(std::uint64_t bound) { return next() % bound; }
  /// In [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

 private:
  std::uint64_t state_;
};

}  // namespace meshlode::judge
