// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces on which quadrics are singular: planes everywhere, cylinders and cones along their rulings.
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/random.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

/// An exactly flat plate; the only cost that tells collapses apart is the pull towards an edge's middle.
Result<Sample> plate(double triangles) {
  const auto n = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
  return sample_of(make_sheet(n, n, false, false, [](double u, double v) { return Vec3d(u, 0.0, -v); }));
}

/// The same in a plane that no axis lies in: coordinates are rounded, so that it is flat to 2^-53 only.
Result<Sample> tilted_plate(double triangles) {
  const auto n = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0));
  return sample_of(make_sheet(n, n, false, false, [](double u, double v) {
    return Vec3d(u * 0.6 + v * 0.1, u * 0.3 - v * 0.7, u * 0.2 + v * 0.5);
  }));
}

/// A plate whose vertices are off their plane by noise of this size.
Result<Sample> noisy_plate(double noise) {
  SplitMix64 random(41);
  Sample sample = sample_of(
      make_sheet(40, 40, false, false, [&](double u, double v) { return Vec3d(u, noise * random.signed_unit(), -v); }));
  sample.feature = 0.0;  // noise is not to be kept
  return sample;
}

Result<Sample> cylinder(double segments) {
  const auto n = static_cast<std::uint32_t>(segments);
  return sample_of(make_sheet(
      n, 24, true, false, [](double u, double v) { return Vec3d(lab::cos_turns(u), 3.0 * v, -lab::sin_turns(u)); }));
}

/// A cone down to its tip, which is one vertex of so many triangles.
Result<Sample> cone(double segments) {
  const auto n = static_cast<std::uint32_t>(segments);
  scene::Primitive shape = make_sheet(n, 12, true, false, [](double u, double v) {
    const double radius = 1.0 - v * (1.0 - 1.0 / 64);
    return Vec3d(radius * lab::cos_turns(u), 2.0 * (1.0 - radius), -radius * lab::sin_turns(u));
  });
  const auto tip = static_cast<std::uint32_t>(shape.positions.size());
  shape.positions.emplace_back(0.0, 2.0, 0.0);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (const std::uint32_t v : {12 * n + i, 12 * n + (i + 1) % n, tip}) shape.indices.push_back(v);
  }
  return sample_of(std::move(shape));
}

}  // namespace

std::vector<HardCase> flat_cases() {
  return {
      {.room = "flat and ruled",
       .name = "plate",
       .parameter = "triangles in one plane",
       .sweep = {2000, 20000, 200000, 1000000},
       .is_quick = true,
       .make = plate},
      {.room = "flat and ruled",
       .name = "tilted-plate",
       .parameter = "triangles in one tilted plane",
       .sweep = {2000, 20000, 200000},
       .is_quick = false,
       .make = tilted_plate},
      {.room = "flat and ruled",
       .name = "noisy-plate",
       .parameter = "noise off the plane, of its side",
       .sweep = {1e-2, 1e-5, 1e-8, 1e-12, 1e-16, 1e-300},
       .is_quick = true,
       .make = noisy_plate},
      {.room = "flat and ruled",
       .name = "cylinder",
       .parameter = "segments around",
       .sweep = {3, 48, 768},
       .is_whole = true,
       .is_quick = false,
       .make = cylinder},
      {.room = "flat and ruled",
       .name = "cone",
       .parameter = "segments around, all at the tip",
       .sweep = {3, 100, 3000},
       .is_whole = true,
       .is_quick = true,
       .make = cone},
  };
}

}  // namespace meshlode::test::hard
