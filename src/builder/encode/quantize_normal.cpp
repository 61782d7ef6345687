// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/quantize_normal.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace meshlode::builder {

namespace {

using Lattice = std::array<std::int32_t, 3>;

/// Nearest integer point of X + Y + Z = m, X, Y, Z >= 0, to a direction of the positive octant. The mirror image of a
/// point across a coordinate plane never has the larger dot product, so the search may stay in the octant.
Lattice nearest_in_octant(double x, double y, double z, std::int32_t m) {
  const double to_plane = m / (x + y + z);
  // One that is such a point but for the rounding of its floats, as what was snapped before is.
  constexpr double kOnPoint = 1.0 / 64;
  const double near_x = std::floor(x * to_plane + 0.5), near_y = std::floor(y * to_plane + 0.5);
  if (std::abs(x * to_plane - near_x) < kOnPoint && std::abs(y * to_plane - near_y) < kOnPoint &&
      near_x + near_y <= m) {
    return {static_cast<std::int32_t>(near_x), static_cast<std::int32_t>(near_y),
            m - static_cast<std::int32_t>(near_x + near_y)};
  }
  const auto x0 = static_cast<std::int32_t>(std::floor(x * to_plane));
  const auto y0 = static_cast<std::int32_t>(std::floor(y * to_plane));
  // Seen from the origin the lattice is stretched by up to sqrt(3) at the octahedron's tips, so the nearest point need
  // not be a corner of the lattice cell that contains the direction: one more row on each side is tried.
  Lattice best{0, 0, m};
  double best_cosine_squared = -1.0;
  for (std::int32_t cx = std::max(x0 - 1, 0); cx <= std::min(x0 + 2, m); ++cx) {
    for (std::int32_t cy = std::max(y0 - 1, 0); cy <= std::min(y0 + 2, m - cx); ++cy) {
      const std::int32_t cz = m - cx - cy;
      const double dot = x * cx + y * cy + z * cz;
      const double length_squared = double(cx) * cx + double(cy) * cy + double(cz) * cz;
      const double cosine_squared = dot * dot / length_squared;
      if (cosine_squared > best_cosine_squared) {
        best_cosine_squared = cosine_squared;
        best = {cx, cy, cz};
      }
    }
  }
  return best;
}

std::int32_t with_sign_of(std::int32_t magnitude, double sign) {
  return sign < 0.0 ? -magnitude : magnitude;
}

}  // namespace

std::array<std::int32_t, 3> nearest_octahedral_point(const Vec3f& normal, std::int32_t scale) {
  const double x = normal.x;
  const double y = normal.y;
  const double z = normal.z;
  const double sum = std::abs(x) + std::abs(y) + std::abs(z);
  if (!(sum > 0.0) || !std::isfinite(sum)) return {0, 0, scale};             // +z: NaN fails the first comparison
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});  // scaled: no square leaves double's range
  const Lattice p = nearest_in_octant(std::abs(x) / largest, std::abs(y) / largest, std::abs(z) / largest, scale);
  return {with_sign_of(p[0], x), with_sign_of(p[1], y), with_sign_of(p[2], z)};
}

Vec3d octahedral_normal(const std::array<std::int32_t, 3>& point) {
  const Vec3d n(point[0], point[1], point[2]);
  const double length = std::sqrt((n.x * n.x + n.y * n.y) + n.z * n.z);
  return {n.x / length, n.y / length, n.z / length};
}

std::array<std::int32_t, 2> chart_coordinates(const std::array<std::int32_t, 3>& point, std::uint32_t chart,
                                              std::int32_t scale) {
  const std::size_t pole = chart / 2;
  const std::int32_t a = point[(pole + 1) % 3];
  const std::int32_t b = point[(pole + 2) % 3];
  const std::int32_t c = chart % 2 == 0 ? point[pole] : -point[pole];
  if (c >= 0) return {a + scale, b + scale};
  // The far half unfolds outward. A zero counts as positive: the two images of a fold edge become one.
  const std::int32_t fa = a < 0 ? std::abs(b) - scale : scale - std::abs(b);
  const std::int32_t fb = b < 0 ? std::abs(a) - scale : scale - std::abs(a);
  return {fa + scale, fb + scale};
}

std::uint64_t octahedral_scale_for(double degrees) {
  constexpr double kDegreesTimesScale = 81.028468454139;  // sqrt(2) * 180 / pi, rounded up
  const double scale = std::ceil(kDegreesTimesScale / degrees);
  return scale < 1.0 ? 1U : scale > 1e18 ? std::uint64_t{1} << 60U : static_cast<std::uint64_t>(scale);
}

}  // namespace meshlode::builder
