// SPDX-License-Identifier: GPL-3.0-or-later
// Seeded numbers that are the same everywhere: splitmix64 (Steele, Lea and Flood 2014), no std:: distributions.
#pragma once

#include <cstdint>

namespace meshlode::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ z >> 30U) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ z >> 27U) * 0x94D049BB133111EBULL;
    return z ^ z >> 31U;
  }
  /// 0 … count - 1. \pre count > 0
  std::uint64_t below(std::uint64_t count) { return next() % count; }
  /// [-1, 1)
  double signed_unit() { return static_cast<double>(next() >> 11U) * 0x1p-52 - 1.0; }

 private:
  std::uint64_t state_;
};

}  // namespace meshlode::test
