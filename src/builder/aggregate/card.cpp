// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/card.h"

#include <algorithm>
#include <cmath>

namespace meshlode::builder {

namespace {

constexpr double kLengthOfHalf = 1.7320508075688772;  // of a rectangle, by the half axis of its moments

/// Of a blade, from its middle to its tip.
Vec3d half_blade(const Splat& splat) {
  return splat.axis_u * (0.5 * kLengthOfHalf * splat.half_u * ((splat.turn & 1U) != 0 ? -1.0 : 1.0));
}

}  // namespace

void Splat::stretch_to_blade(double times) {
  is_blade = true;
  half_u *= times;
  center += half_blade(*this) / 3.0;  // a triangle's centroid is that much nearer to its base
}

void Splat::turn_to(std::uint32_t way_up) {
  const Vec3d was = half_blade(*this);
  turn = way_up;
  if (is_blade) center += (half_blade(*this) - was) / 3.0;
}

Corners Splat::corners(double factor) const {
  // An equilateral triangle around 0 with corners at a distance of 1 has this area; stretched along the axes of an
  // ellipse it has the ellipse's second moments but for a factor, which the area decides.
  constexpr double kUnitArea = 1.299038105676658;  // 3 sqrt(3) / 4
  constexpr double kHalfSide = 0.8660254037844386;
  const double wanted = factor * area;
  if (is_blade) {
    // Of a short one that stands for much the base would be longer than it is high: it grows as high, around its
    // centroid.
    const double length = kLengthOfHalf * half_u, high = std::max(length, std::sqrt(2.0 * wanted));
    const Vec3d was = half_blade(*this), half = length > 0.0 ? was * (high / length) : was;
    const Vec3d middle = center + (half - was) / 3.0;
    const Vec3d side = axis_v * (wanted / std::max(high, 1e-300) * ((turn & 1U) != 0 ? -1.0 : 1.0));
    return {middle + half, middle - half + side, middle - half - side};
  }
  const double ratio = std::sqrt(wanted / kUnitArea / std::max(half_u * half_v, 1e-300));
  Vec3d u = axis_u * (half_u * ratio), v = axis_v * (half_v * ratio);
  if ((turn & 1U) != 0) {
    const Vec3d old = u;
    u = v;
    v = -old;
  }
  if ((turn & 2U) != 0) {
    u = -u;
    v = -v;
  }
  return {center + v, center - kHalfSide * u - 0.5 * v, center + kHalfSide * u - 0.5 * v};
}

}  // namespace meshlode::builder
