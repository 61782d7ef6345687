// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/exact.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace meshlode::judge {

namespace {

/// A number as a sum of doubles that do not overlap, smallest first (Shewchuk 1997, "Adaptive Precision Floating-Point
/// Arithmetic"). No rounding ever happens; the sign is that of the last component.
class Expansion {
 public:
  void add(double value) {
    double carry = value;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = carry + terms_[i];
      const double b = sum - carry;
      const double error = (carry - (sum - b)) + (terms_[i] - b);
      carry = sum;
      if (error != 0.0) terms_[kept++] = error;
    }
    if (carry != 0.0) terms_[kept++] = carry;
    size_ = kept;
    assert(size_ < terms_.size());
  }

  void add_product(double a, double b) {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }

  /// Adds sign · other².
  void add_square(const Expansion& other, double sign) { add_product(other, other, sign); }

  /// Adds sign · a · b.
  void add_product(const Expansion& a, const Expansion& b, double sign) {
    for (std::size_t i = 0; i < a.size_; ++i) {
      for (std::size_t j = 0; j < b.size_; ++j) add_product(sign * a.terms_[i], b.terms_[j]);
    }
  }

  [[nodiscard]] int sign() const {
    if (size_ == 0) return 0;
    return terms_[size_ - 1] > 0.0 ? 1 : -1;
  }

 private:
  std::array<double, 80> terms_{};
  std::size_t size_ = 0;
};

Expansion difference(double a, double b) {
  Expansion out;
  out.add(a);
  out.add(-b);
  return out;
}

}  // namespace

bool contains_ball(const ExactBall& outer, const ExactBall& inner) {
  const double room = double{outer.radius} - double{inner.radius};
  if (outer.radius < inner.radius) return false;
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double d = double{outer.center[i]} - double{inner.center[i]};
    squared += d * d;
  }
  // Doubles decide unless the two sides are within a few of their roundings of each other.
  if (squared < room * room * (1.0 - 1e-14)) return true;
  if (squared > room * room * (1.0 + 1e-14) && squared > 1e-280) return false;
  Expansion value;
  value.add_square(difference(outer.radius, inner.radius), 1.0);
  for (int i = 0; i < 3; ++i) value.add_square(difference(outer.center[i], inner.center[i]), -1.0);
  return value.sign() >= 0;
}

bool contains_point(const ExactBall& ball, const Vec3d& point) {
  const double room = double{ball.radius};
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double d = point[i] - double{ball.center[i]};
    squared += d * d;
  }
  if (squared < room * room * (1.0 - 1e-14)) return true;
  if (squared > room * room * (1.0 + 1e-14) && squared > 1e-280) return false;
  Expansion value;
  value.add_product(room, room);
  for (int i = 0; i < 3; ++i) value.add_square(difference(point[i], ball.center[i]), -1.0);
  return value.sign() >= 0;
}

}  // namespace meshlode::judge
