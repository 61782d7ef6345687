// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/validate/margin.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <meshlode/format.h>

namespace meshlode::judge {

namespace {

// u = 2^-24, half an ulp of a float, relative.
constexpr long double kRadiusMargin = 6.0L * 0x1p-24L;  ///< of each radius
constexpr long double kCenterMargin = 6.0L * 0x1p-24L;  ///< of each centre's distance from the mesh's origin
constexpr long double kErrorMargin = 12.0L * 0x1p-24L;  ///< of the finer error
/// The square roots below are rounded, 2^-60 relative at most, which is 2^-36 of the margin itself.
constexpr long double kOwnRounding = 0x1p-58L;

long double length(long double x, long double y, long double z) {
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

bool has_error_margin(float finer, float coarser) {
  if (finer == 0.0F || coarser >= format::kInfiniteError) return true;
  return static_cast<long double>(coarser) >= static_cast<long double>(finer) * (1.0L + kErrorMargin);
}

bool has_sphere_margin(const ExactBall& coarser, const ExactBall& finer) {
  const long double distance = length(static_cast<long double>(coarser.center[0]) - finer.center[0],
                                      static_cast<long double>(coarser.center[1]) - finer.center[1],
                                      static_cast<long double>(coarser.center[2]) - finer.center[2]);
  const long double from_origin = length(coarser.center[0], coarser.center[1], coarser.center[2]) +
                                  length(finer.center[0], finer.center[1], finer.center[2]);
  const long double needed = distance + finer.radius * (1.0L + kRadiusMargin) + kCenterMargin * from_origin;
  return coarser.radius * (1.0L - kRadiusMargin) >= needed * (1.0L - kOwnRounding);
}

bool are_same_bits(const ExactBall& a, const ExactBall& b) {
  using Bits = std::array<std::uint32_t, 4>;
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

}  // namespace meshlode::judge
