// SPDX-License-Identifier: GPL-3.0-or-later
// The bounds of docs/explanation/numerics.md against rational numbers and 113 bits of mantissa, each with the largest
// share of the bound that was seen (printed, and kept in the document).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <vector>

#include "builder/hierarchy/lod_bounds.h"
#include "builder/simplify/quadric.h"
#include "format/grid.h"
#include "hard/share.h"
#include "run/read/nesting.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::test::hard {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Quad = boost::multiprecision::cpp_bin_float_quad;

constexpr double kFloat = 0x1p-24, kDouble = 0x1p-53;

TEST(Numerics, QuantizationMovesACoordinateByHalfAStepAndItsRounding) {
  RandomSource random(71);
  Worst power_of_two, given_step;
  for (int round = 0; round < 40000; ++round) {
    format::PositionGrid grid;
    grid.log2 = -60 + static_cast<int>(random.below(120));
    const bool is_given = round % 2 == 1;
    grid.mantissa = is_given ? 2 * random.below(127) + 3 : 1;
    const double step = grid.step();
    const double origin =
        std::floor(random.between(-1.0, 1.0) * std::ldexp(1.0, static_cast<int>(random.below(40)))) * step;
    // Up to 2^22 steps from the origin, and as near to the middle between two points as doubles go.
    const double steps = std::floor(random.between(-1.0, 1.0) * std::ldexp(1.0, static_cast<int>(random.below(23))));
    const double p = origin + (steps + 0.5) * step * (1.0 + kDouble * (static_cast<double>(random.below(9)) - 4.0));
    const double relative = p - origin;
    const int q = grid.quantize(Vec3d(relative, 0.0, 0.0)).x;
    const Rational exact = Rational(p) - Rational(origin);
    const Rational moved = abs(Rational(q) * Rational(step) - exact);
    // v |p - o| of the difference, and as much of the quotient where the step is no power of two.
    const Rational bound = Rational(step) * (Rational(0.5) + Rational(0x1p-30)) +
                           Rational(is_given ? 2.0 * kDouble : kDouble) * abs(exact);
    (is_given ? given_step : power_of_two).take(Rational(moved / bound).convert_to<double>(), round);
  }
  expect_kept("quantization, a step that is a power of two", power_of_two, 0.99);
  expect_kept("quantization, a given step", given_step, 0.99);
}

Quad length_of(const std::array<Quad, 3>& v) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
std::array<Quad, 3> quads(const float (&v)[3]) {
  return {Quad(v[0]), Quad(v[1]), Quad(v[2])};
}

TEST(Numerics, ASphereOfSpheresHoldsThemWithTheMargin) {
  RandomSource random(72);
  const Quad u = kFloat;
  Worst worst;
  for (int round = 0; round < 4000; ++round) {
    const double size = random.log_between(1e-20, 1e20), away = size * random.log_between(1e-3, 1e6);
    const Vec3d middle = random.in_cube(away);
    std::vector<builder::Hierarchy::Sphere> inner(1 + random.below(6));
    for (builder::Hierarchy::Sphere& s : inner) {
      const Vec3d c = middle + random.in_cube(size);
      s = {{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)},
           static_cast<float>(size * random.log_between(1e-6, 1.0))};
    }
    const builder::Hierarchy::Sphere outer = builder::enclose_spheres(inner);
    const auto center = quads(outer.center);
    for (const builder::Hierarchy::Sphere& s : inner) {
      const auto c = quads(s.center);
      const Quad between = length_of({center[0] - c[0], center[1] - c[1], center[2] - c[2]});
      const Quad needed = between + Quad(s.radius) * (1 + 8 * u) + 8 * u * (length_of(center) + length_of(c));
      worst.take((needed / (Quad(outer.radius) * (1 - 8 * u))).convert_to<double>(), round);
    }
  }
  // What is left is rounding up to a float: less than 2u of the radius.
  expect_kept("spheres", worst, 1.0 - 2.5 * kFloat);
}

/// (E + R - d) over 8u (2 sigma |c| + d) of a group that passed; nothing where it did not, or by the near distance.
double overstep(const run::Camera& camera, double pixel_error, const format::InstanceRecord& instance,
                const run::StoredBound& b, double d) {
  const Quad sigma = instance.scale;
  const Quad pixels = Quad(camera.height) / (2 * tan(Quad(camera.fovy) / 2));
  const Quad e = Quad(b.error) * sigma * pixels / Quad(pixel_error);
  std::array<Quad, 3> away;
  for (std::size_t row = 0; row < 3; ++row) {
    const double* m = instance.transform + 4 * row;
    away[row] = Quad(m[3]) - Quad(camera.eye[static_cast<int>(row)]);
    for (std::size_t k = 0; k < 3; ++k) away[row] += Quad(m[k]) * Quad(b.center[k]);
  }
  const Quad distance = length_of(away);
  EXPECT_NEAR(distance.convert_to<double>(), d, 1e-6 * d + 1e-12 * std::abs(instance.transform[3]));
  const Quad over = e + Quad(b.radius) * sigma - distance;
  const Quad allowed = 8 * Quad(kFloat) * (2 * sigma * length_of(quads(b.center)) + distance);
  return (over / allowed).convert_to<double>();
}

TEST(Numerics, WhatPassesInFloatsPassesInRealNumbersButForTheBound) {
  RandomSource random(73);
  Worst worst;
  int passing = 0;
  constexpr std::array<TransformKind, 4> kKinds{TransformKind::kRigid, TransformKind::kMirrored,
                                                TransformKind::kNonUniform, TransformKind::kSheared};
  for (int round = 0; round < 60000; ++round) {
    const double size = random.log_between(1e-9, 1e9);
    const format::InstanceRecord instance = make_random_instance(random, kKinds[round % 4], size);
    const double sigma = instance.scale;
    const Vec3d c = random.in_cube(size);
    run::StoredBound b{{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)},
                       static_cast<float>(size * random.log_between(1e-7, 1.0)),
                       static_cast<float>(size * random.log_between(1e-9, 1e-1))};
    Vec3d world;
    for (int row = 0; row < 3; ++row) {
      const double* m = instance.transform + 4 * row;
      world[row] = m[0] * b.center[0] + m[1] * b.center[1] + m[2] * b.center[2] + m[3];
    }
    run::Camera camera;
    camera.width = 1280;
    camera.height = 720;
    camera.eye = world + random.direction() * (double{b.radius} * sigma * (1.0 + random.log_between(1e-6, 1e3)));
    const double d = glm::length(camera.eye - world), room = d - double{b.radius} * sigma;
    if (!(room > 0.0)) continue;
    camera.near_distance = 1e-6 * room;
    const double pixels = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
    // As few pixels as still pass: between what surely fails and what surely passes, halved.
    const double length = glm::length(Vec3d(b.center[0], b.center[1], b.center[2]));
    const double exact = double{b.error} * sigma * pixels / room, spread = 1e-5 * (1.0 + (sigma * length + d) / room);
    double fails = exact / (1.0 + spread), passes = exact * (1.0 + spread);
    const auto does_pass = [&](double pixel_error) {
      const run::MetricView view =
          run::make_metric_view(camera, pixel_error, instance, format::MeshRecord{}, length + b.radius);
      return run::metric_passes(view, b.center[0], b.center[1], b.center[2], b.radius, b.error);
    };
    if (!does_pass(passes)) continue;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (fails + passes);
      (does_pass(middle) ? passes : fails) = middle;
    }
    ++passing;
    worst.take(overstep(camera, passes, instance, b, d), round);
  }
  EXPECT_GT(passing, 40000);
  expect_kept("projection", worst, 0.01);
}

TEST(Numerics, AQuadricThatIsTrustedIsSolvedToItsResidual) {
  RandomSource random(74);
  Worst worst;
  int refused = 0;
  for (int round = 0; round < 60000; ++round) {
    // Planes that meet at angles down to 1e-8, of very different weights.
    builder::Quadric quadric;
    const Vec3d first = random.direction();
    const double spread = random.log_between(1e-8, 1.0);
    for (std::uint32_t i = 0; i < 3 + random.below(5); ++i) {
      const Vec3d n = glm::normalize(first + random.direction() * spread);
      quadric.add_plane(n, random.between(-1.0, 1.0), random.log_between(1e-4, 1.0));
    }
    Vec3d p;
    if (!quadric.minimize(p)) {
      ++refused;
      continue;
    }
    const Quad x = p.x, y = p.y, z = p.z;
    const std::array<Quad, 3> rest{
        Quad(quadric.a00()) * x + Quad(quadric.a01()) * y + Quad(quadric.a02()) * z + Quad(quadric.b0()),
        Quad(quadric.a01()) * x + Quad(quadric.a11()) * y + Quad(quadric.a12()) * z + Quad(quadric.b1()),
        Quad(quadric.a02()) * x + Quad(quadric.a12()) * y + Quad(quadric.a22()) * z + Quad(quadric.b2())};
    const Quad trace = Quad(quadric.a00()) + Quad(quadric.a11()) + Quad(quadric.a22());
    const Quad bound = 31 * Quad(kDouble) * trace * length_of({x, y, z});
    worst.take((length_of(rest) / bound).convert_to<double>(), round);
  }
  EXPECT_GT(refused, 1000) << "without systems that are refused the limit is not tried";
  expect_kept("quadric solve", worst, 0.005);
}

}  // namespace
}  // namespace meshlode::test::hard
