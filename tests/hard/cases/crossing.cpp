// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that cross, enclose or nearly touch themselves.
#include <cmath>
#include <cstddef>
#include <utility>

#include "builder/odd_shapes.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

/// A lump whose vertices are thrown about by so many edge lengths: everything crosses everything.
Result<Sample> crumpled(double edges) {
  const std::uint32_t n = 10;
  const double size = edges / n;
  std::uint64_t at = 0;
  Sample sample = sample_of(mapped(make_lump(n), [&](const Vec3d& p) {
    const auto noise = [&](std::uint64_t k) {
      std::uint64_t x = (at * 3 + k + 1) * 0x9E3779B97F4A7C15U;
      x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
      x ^= x >> 27U;
      return static_cast<double>(x >> 11U) * 0x1p-52 - 1.0;
    };
    const Vec3d moved = p + Vec3d(noise(0), noise(1), noise(2)) * size;
    ++at;
    return moved;
  }));
  sample.crosses_itself = true;
  return sample;
}

/// A closed body of two faces that are so far apart.
Result<Sample> blade(double thickness) {
  Sample sample = sample_of(lab::make_blade(24, thickness));
  sample.feature = thickness;
  return sample;
}

/// A lump with a closed pocket inside, the wall between them so thick.
Result<Sample> pocket(double wall) {
  Sample sample = sample_of(joined(make_lump(12, 0.05), turned(lab::scaled(make_lump(12, 0.05), 1.0 - wall))));
  sample.feature = wall;
  return sample;
}

/// Spheres in the same place, each with vertices of its own.
Result<Sample> coincident(double sheets) {
  Sample sample = sample_of(make_coincident_spheres(8, static_cast<std::uint32_t>(sheets)));
  sample.crosses_itself = true;
  return sample;
}

}  // namespace

std::vector<HardCase> crossing_cases() {
  return {
      {.room = "crossing",
       .name = "crumpled",
       .parameter = "how far vertices are thrown, edge lengths",
       .sweep = {0.1, 1.0, 10.0},
       .is_quick = true,
       .make = crumpled},
      {.room = "crossing",
       .name = "blade",
       .parameter = "thickness, of a length of 2",
       .sweep = {1e-1, 1e-3, 1e-5, 1e-7, 1e-12},
       .is_quick = true,
       .make = blade},
      {.room = "crossing",
       .name = "pocket",
       .parameter = "thickness of the wall, of a radius of 1",
       .sweep = {1e-1, 1e-3, 1e-5, 1e-7, 1e-12},
       .is_quick = false,
       .make = pocket},
      {.room = "crossing",
       .name = "coincident",
       .parameter = "spheres in the same place",
       .sweep = {2, 8, 32},
       .is_whole = true,
       .is_quick = false,
       .make = coincident},
  };
}

}  // namespace meshlode::test::hard
