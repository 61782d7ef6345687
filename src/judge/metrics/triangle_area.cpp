// SPDX-License-Identifier: GPL-3.0-or-later
// Each component of the cross product is a sum of six products of two coordinates. Doubles decide where they can; else
// the products are added up in fixed point, from the smallest product that two doubles can have to the largest
// (Kulisch 1971), where nothing rounds.
#include "judge/metrics/triangle_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace meshlode::judge {
namespace {

__extension__ using UInt128 = unsigned __int128;

class ExactSum {
 public:
  /// Adds x · y. At most 2^20 times.
  void add_product(double x, double y) {
    if (x == 0.0 || y == 0.0) return;
    int ex = 0, ey = 0;
    const auto mx = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &ex), 53));
    const auto my = static_cast<std::int64_t>(std::ldexp(std::frexp(y, &ey), 53));
    const auto place = static_cast<std::size_t>(ex + ey - 106 - kLowest);
    const auto magnitude = static_cast<std::uint64_t>(std::abs(mx)) * UInt128{static_cast<std::uint64_t>(std::abs(my))};
    const bool is_negative = (mx < 0) != (my < 0);
    std::size_t digit = place / kDigitBits;
    UInt128 rest = magnitude;
    for (std::size_t shift = place % kDigitBits; rest != 0; shift = 0, ++digit) {
      // The first digit takes what is left of it above `shift`; the others whole ones.
      const std::size_t taken = kDigitBits - shift;
      const auto part = static_cast<std::int64_t>((rest & ((UInt128{1} << taken) - 1)) << shift);
      digits_[digit] += is_negative ? -part : part;
      rest >>= taken;
    }
  }

  [[nodiscard]] bool is_zero() const {
    std::int64_t carry = 0;
    for (const std::int64_t digit : digits_) {
      const std::int64_t value = digit + carry;
      if ((value & kDigitMask) != 0) return false;
      carry = value >> kDigitBits;
    }
    return carry == 0;
  }

 private:
  static constexpr int kLowest = 2 * (-1074 - 53);  ///< exponent of digit 0, below that of any product
  static constexpr std::size_t kDigitBits = 32;
  static constexpr std::int64_t kDigitMask = 0xFFFFFFFFLL;
  std::array<std::int64_t, (2 * (1074 + 53) + 2 * 1024) / 32 + 6> digits_{};
};

struct Axes {
  int u, v;
};
constexpr std::array kPlanes = {Axes{1, 2}, Axes{2, 0}, Axes{0, 1}};

/// Whether doubles can tell that (b - a) × (c - a) is not 0 in the plane of two axes.
bool is_clearly_wide(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Axes& axes) {
  const auto [u, v] = axes;
  const double left = (b[u] - a[u]) * (c[v] - a[v]);
  const double right = (b[v] - a[v]) * (c[u] - a[u]);
  const double size = std::fabs(left) + std::fabs(right);
  // Four roundings at most lie between these and the truth, unless a product was too small to be normal.
  return size > 1e-250 && std::fabs(left - right) > 0x1p-50 * size;
}

bool is_exactly_flat(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Axes& axes) {
  const auto [u, v] = axes;
  ExactSum sum;
  for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    sum.add_product(p[u], q[v]);
    sum.add_product(-p[v], q[u]);
  }
  return sum.is_zero();
}

}  // namespace

bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  for (const Axes& axes : kPlanes) {
    if (is_clearly_wide(a, b, c, axes)) return true;
  }
  return !std::all_of(kPlanes.begin(), kPlanes.end(), [&](const Axes& axes) { return is_exactly_flat(a, b, c, axes); });
}

}  // namespace meshlode::judge
