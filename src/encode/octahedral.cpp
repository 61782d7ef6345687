// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode/octahedral.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace meshlode {

namespace {

using Lattice = std::array<std::int32_t, 3>;

/// Nearest integer point of X + Y + Z = m, X, Y, Z >= 0, to a direction of the positive octant. The mirror image of a
/// point across a coordinate plane never has the larger dot product, so the search may stay in the octant.
Lattice nearest_in_octant(double x, double y, double z, std::int32_t m) {
  const double to_plane = m / (x + y + z);
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

std::int32_t with_sign_of(std::int32_t magnitude, double sign) { return sign < 0.0 ? -magnitude : magnitude; }

}  // namespace

std::array<std::int32_t, 2> encode_octahedral(const Vec3f& normal, std::uint32_t bits) {
  const std::int32_t m = (1 << (bits - 1)) - 1;
  const double x = normal.x;
  const double y = normal.y;
  const double z = normal.z;
  const double sum = std::abs(x) + std::abs(y) + std::abs(z);
  if (!(sum > 0.0) || !std::isfinite(sum)) return {m, m};  // +z: NaN fails the first comparison
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});  // scaled: no square leaves double's range
  const Lattice p = nearest_in_octant(std::abs(x) / largest, std::abs(y) / largest, std::abs(z) / largest, m);
  const std::int32_t px = with_sign_of(p[0], x);
  const std::int32_t py = with_sign_of(p[1], y);
  if (z >= 0.0 || p[2] == 0) return {px + m, py + m};
  // The lower half unfolds outward. A zero counts as positive: -0 and the two images of a fold edge become one.
  const std::int32_t fx = px < 0 ? -(m - p[1]) : m - p[1];
  const std::int32_t fy = py < 0 ? -(m - p[0]) : m - p[0];
  return {fx + m, fy + m};
}

}  // namespace meshlode
