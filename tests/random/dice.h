// SPDX-License-Identifier: GPL-3.0-or-later
// What the random scenes are thrown with. Every draw is a statement or a braced element of its own: the order in which
// a call's arguments are drawn is the compiler's choice, and a seed has to mean the same scene everywhere.
#pragma once

#include <cmath>

#include "base/vec.h"
#include "support/random.h"

namespace meshlode::test {

class Dice : public Random {
 public:
  using Random::Random;
  double range(double low, double high) { return Random::between(low, high); }
  /// low … high, both included. \pre low <= high
  std::uint32_t between(std::uint32_t low, std::uint32_t high) {
    return low + static_cast<std::uint32_t>(below(std::uint64_t{high} - low + 1));
  }
  /// A factor of any size from 2^low to 2^high, each power as likely as the next. \pre low < high
  double octaves(int low, int high) {
    const int power = low + static_cast<int>(below(static_cast<std::uint64_t>(high - low)));
    return std::ldexp(1.0 + unit(), power);
  }
  /// In the cube from -size to size.
  Vec3d vector(double size) {
    Vec3d v;
    for (int k = 0; k < 3; ++k) v[k] = size * signed_unit();
    return v;
  }
  /// Of length 1.
  Vec3d direction() {
    for (;;) {
      const Vec3d v = vector(1.0);
      const double square = glm::dot(v, v);
      if (square > 0.01 && square < 1.0) return v / std::sqrt(square);
    }
  }
};

}  // namespace meshlode::test
