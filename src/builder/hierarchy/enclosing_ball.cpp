// SPDX-License-Identifier: GPL-3.0-or-later
// Smallest enclosing ball of balls: Fischer and Gärtner 2003, as CGAL's Min_sphere_of_spheres_d (the one file of this
// room that sees CGAL). Its farthest-first heuristic draws no random numbers, and with CGAL_JUST_MINIBALL it needs no
// kernel, hence no -frounding-math: GCC and Clang give the same bits. It works on doubles without error bounds, so its
// answer is measured here and the box's centre is taken where it is not better.
#define CGAL_JUST_MINIBALL
#define CGAL_NO_ASSERTIONS
#include <CGAL/Min_sphere_of_spheres_d.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/box.h"
#include "builder/hierarchy/enclosing_ball.h"

namespace meshlode::builder {
namespace {

using Packed = std::array<double, 4>;  // x y z radius

// NOLINTBEGIN(readability-identifier-naming): CGAL asks for these names.
struct PackedTraits {
  using FT = double;
  using Sphere = Packed;
  using Cartesian_const_iterator = const double*;
  using Use_square_roots = CGAL::Tag_true;
  using Algorithm = CGAL::Farthest_first_heuristic;
  static const int D = 3;
  static const double& radius(const Sphere& s) { return s[3]; }
  static const double* center_cartesian_begin(const Sphere& s) { return s.data(); }
};
// NOLINTEND(readability-identifier-naming)

double radius_around(const std::vector<Packed>& balls, const Vec3d& center) {
  double radius = 0.0;
  for (const Packed& b : balls) {
    const double x = b[0] - center.x, y = b[1] - center.y, z = b[2] - center.z;
    radius = std::max(radius, std::sqrt((x * x + y * y) + z * z) + b[3]);
  }
  return radius;
}

}  // namespace

Ball enclosing_ball(std::span<const Ball> balls) {
  Box3d box;
  for (const Ball& b : balls) box.add({b.center - b.radius, b.center + b.radius});
  const Vec3d extent = box.size();
  const Vec3d middle = box.low + extent * 0.5;
  const double size = std::max(extent.x, std::max(extent.y, extent.z));
  if (!(size > 0.0) || balls.size() == 1) return balls[0];

  // About the box's centre and scaled to about 1 by a power of two, so that squares neither underflow nor lose the
  // features of a far-away group.
  int exponent = 0;
  std::frexp(size, &exponent);
  exponent = std::clamp(exponent, -1000, 1000);
  const double unit = std::ldexp(1.0, -exponent);
  std::vector<Packed> packed;
  packed.reserve(balls.size());
  for (const Ball& b : balls) {
    const Vec3d c = (b.center - middle) * unit;
    packed.push_back({c.x, c.y, c.z, b.radius * unit});
  }
  Vec3d center(0.0);
  double radius = radius_around(packed, center);
  CGAL::Min_sphere_of_spheres_d<PackedTraits> smallest(packed.begin(), packed.end());
  const double* c = smallest.center_cartesian_begin();
  const Vec3d candidate(c[0], c[1], c[2]);
  const double candidate_radius = radius_around(packed, candidate);
  if (candidate_radius < radius) {  // false for NaN
    center = candidate;
    radius = candidate_radius;
  }
  const double scale = std::ldexp(1.0, exponent);
  return {middle + center * scale, radius * scale};
}

}  // namespace meshlode::builder
