// SPDX-License-Identifier: MIT
// Seeded random numbers, the same on every machine and C++ library (std:: distributions differ between them):
// splitmix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators").
#pragma once

#include <cmath>
#include <cstdint>

namespace meshlode {

/// 2^64 over the golden ratio, odd: what each step adds, and a factor that spreads numbers over 64 bits.
constexpr std::uint64_t kGoldenGamma = 0x9E3779B97F4A7C15U;

/// splitmix64's finalizer: a bijection of 64 bits in which each bit depends on all.
constexpr std::uint64_t mix64(std::uint64_t z) {
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  return z ^ (z >> 31U);
}

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() { return mix64(state_ += kGoldenGamma); }
  /// In [0, bound), as a remainder. \pre bound > 0
  std::uint64_t below(std::uint64_t bound) { return next() % bound; }
  /// In [0, bound), by scaling the upper 32 bits. \pre bound > 0
  std::uint32_t scaled_below(std::uint32_t bound) { return static_cast<std::uint32_t>((next() >> 32U) * bound >> 32U); }
  double unit() { return static_cast<double>(next() >> 11U) * 0x1p-53; }               ///< in [0, 1)
  double signed_unit() { return static_cast<double>(next() >> 11U) * 0x1p-52 - 1.0; }  ///< in [-1, 1)
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Each power as likely as the next. \pre 0 < low <= high
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool chance(double probability) { return unit() < probability; }

 private:
  std::uint64_t state_;
};

}  // namespace meshlode
