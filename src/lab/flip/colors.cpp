// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/flip/colors.h"

#include <cmath>

namespace meshlode::lab {

namespace {

/// A matrix by its rows.
struct Matrix {
  Vec3d x, y, z;
  [[nodiscard]] Vec3d operator*(const Vec3d& v) const { return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)}; }
};

Matrix inverse(const Matrix& m) {
  const Vec3d yz = glm::cross(m.y, m.z), zx = glm::cross(m.z, m.x), xy = glm::cross(m.x, m.y);
  const double scale = 1.0 / glm::dot(m.x, yz);
  return {scale * Vec3d(yz.x, zx.x, xy.x), scale * Vec3d(yz.y, zx.y, xy.y), scale * Vec3d(yz.z, zx.z, xy.z)};
}

/// XYZ of a chromaticity, with Y = 1.
Vec3d xyz_of(double x, double y) {
  return {x / y, 1.0, (1.0 - x - y) / y};
}

struct Spaces {
  Vec3d white = xyz_of(0.3127, 0.3290);  // D65
  Matrix to_xyz{}, from_xyz{};

  Spaces() {
    const Vec3d r = xyz_of(0.64, 0.33), g = xyz_of(0.30, 0.60), b = xyz_of(0.15, 0.06);
    const Matrix primaries{{r.x, g.x, b.x}, {r.y, g.y, b.y}, {r.z, g.z, b.z}};
    const Vec3d share = inverse(primaries) * white;  // of each primary in white
    to_xyz = {primaries.x * share, primaries.y * share, primaries.z * share};
    from_xyz = inverse(to_xyz);
  }
};

const Spaces& spaces() {
  static const Spaces the_spaces;
  return the_spaces;
}

double lab_curve(double t) {
  constexpr double kDelta = 6.0 / 29.0;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
}

}  // namespace

double linear_of_srgb(std::uint8_t value) {
  const double s = value / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

Vec3d ycxcz_of_linear(const Vec3d& rgb) {
  const Vec3d n = spaces().to_xyz * rgb / spaces().white;
  return {116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z)};
}

Vec3d linear_of_ycxcz(const Vec3d& opponent) {
  const double y = (opponent.x + 16.0) / 116.0;
  return spaces().from_xyz * (Vec3d(y + opponent.y / 500.0, y, y - opponent.z / 200.0) * spaces().white);
}

Vec3d hunt_lab_of_linear(const Vec3d& rgb) {
  const Vec3d n = spaces().to_xyz * rgb / spaces().white;
  const double fx = lab_curve(n.x), fy = lab_curve(n.y), fz = lab_curve(n.z);
  const double lightness = 116.0 * fy - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (fx - fy), 0.01 * lightness * 200.0 * (fy - fz)};
}

double hyab(const Vec3d& a, const Vec3d& b) {
  const Vec3d d = a - b;
  return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

}  // namespace meshlode::lab
