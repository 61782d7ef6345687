// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/encode/quantize_normal.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace meshlode::builder {

namespace {

using Lattice = std::array<std::int32_t, 3>;
using Pair = double __attribute__((vector_size(16)));

/// Nearest integer point of X + Y + Z = m, X, Y, Z >= 0, to a direction of the positive octant. The mirror image of a
/// point across a coordinate plane never has the larger dot product, so the search may stay in the octant.
Lattice nearest_in_octant(double x, double y, double z, std::int32_t m) {
  const double to_plane = m / (x + y + z);
  // One that is such a point but for the rounding of its floats, as what was snapped before is.
  constexpr double kOnPoint = 1.0 / 64;
  const auto near_x = static_cast<std::int32_t>(x * to_plane + 0.5);
  const auto near_y = static_cast<std::int32_t>(y * to_plane + 0.5);
  if (std::abs(x * to_plane - near_x) < kOnPoint && std::abs(y * to_plane - near_y) < kOnPoint &&
      near_x + near_y <= m) {
    return {near_x, near_y, m - (near_x + near_y)};
  }
  const auto x0 = static_cast<std::int32_t>(x * to_plane), y0 = static_cast<std::int32_t>(y * to_plane);
  // Seen from the origin the lattice is stretched by up to sqrt(3) at the octahedron's tips, so the nearest point need
  // not be a corner of the lattice cell that contains the direction: one more row on each side is tried.
  const std::int32_t first_x = std::max(x0 - 1, 0), first_y = std::max(y0 - 1, 0);
  std::int32_t best = 0;  // 4 rows of 4
  double best_cosine_squared = -1.0;
  for (std::int32_t i = 0; i < 4; ++i) {
    const std::int32_t cx = first_x + i, most_y = std::min(y0 + 2, m - cx);
    if (cx > x0 + 2 || first_y > most_y) break;
    std::array<Pair, 2> cosine_squared;
    for (std::int32_t half = 0; half < 2; ++half) {
      const double y_of_first = first_y + 2 * half, left = m - cx;
      const Pair px{double(cx), double(cx)}, py{y_of_first, y_of_first + 1.0}, pz = Pair{left, left} - py;
      const Pair dot = Pair{x, x} * px + Pair{y, y} * py + Pair{z, z} * pz;
      cosine_squared[static_cast<std::size_t>(half)] = dot * dot / (px * px + py * py + pz * pz);
    }
    // Which is the best is a toss: no branch.
    for (std::int32_t j = 0; j < 4; ++j) {
      const double other = cosine_squared[static_cast<std::size_t>(j / 2)][j % 2];
      const bool is_better = (other > best_cosine_squared) & (first_y + j <= most_y);
      best_cosine_squared = is_better ? other : best_cosine_squared;
      best = is_better ? 4 * i + j : best;
    }
  }
  const std::int32_t cx = first_x + best / 4, cy = first_y + best % 4;
  return {cx, cy, m - cx - cy};
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
