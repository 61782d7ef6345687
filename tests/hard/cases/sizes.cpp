// SPDX-License-Identifier: GPL-3.0-or-later
// Counts at which something fills up: a cluster, a group, 16 bits, one vertex.
#include <cmath>
#include <cstddef>
#include <utility>

#include "builder/odd_shapes.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

/// A strip of exactly so many triangles, wavy.
Result<Sample> strip(double triangles) {
  const auto count = static_cast<std::uint32_t>(triangles);
  scene::Primitive shape =
      make_sheet(1 + count / 2, 1, false, false, [](double u, double v) { return Vec3d(8.0 * u, u * (1.0 - u), -v); });
  shape.indices.resize(std::size_t{3} * count);
  return sample_of(std::move(shape));
}

/// A lump of about so many triangles: one cluster, one group, several.
Result<Sample> lump(double cells) {
  return sample_of(make_lump(static_cast<std::uint32_t>(cells)));
}

Result<Sample> fan(double valence) {
  return sample_of(make_fan(static_cast<std::uint32_t>(valence)));
}

Result<Sample> loose(double triangles) {
  Sample sample = sample_of(lab::make_loose_pieces(static_cast<std::uint32_t>(triangles / 2.0)));
  sample.crosses_itself = true;
  return sample;
}

/// Vertices of their own for each corner: more than 65,535 of them.
Result<Sample> unshared(double triangles) {
  const auto n = static_cast<std::uint32_t>(triangles);
  scene::Primitive shape;
  shape.material = MaterialId(0U);
  const scene::Primitive sheet =
      make_sheet(n / 32, 16, false, false, [](double u, double v) { return Vec3d(4.0 * u, 0.2 * u * v, -v); });
  for (const std::uint32_t v : sheet.indices) {
    shape.indices.push_back(static_cast<std::uint32_t>(shape.positions.size()));
    shape.positions.push_back(sheet.positions[v]);
  }
  return sample_of(std::move(shape));
}

/// Two sheets in one list of triangles: two fifths are of a small fine one, and each of them has an even number.
/// Whoever looks at every second triangle sees another mesh than it is.
Result<Sample> interleaved(double triangles) {
  const auto n = static_cast<std::uint32_t>(std::sqrt(0.3 * triangles));
  const scene::Primitive coarse =
      make_sheet(n, n, false, false, [](double u, double v) { return Vec3d(u, 0.1 * u * v, -v); });
  const auto m = static_cast<std::uint32_t>(std::sqrt(0.2 * triangles));
  const scene::Primitive fine = make_sheet(
      m, m, false, false, [](double u, double v) { return Vec3d(1.1 + 0.01 * u, 0.001 * u * v, -0.01 * v); });
  scene::Primitive both = joined(coarse, fine);
  const std::size_t of_fine = fine.indices.size() / 3, of_coarse = coarse.indices.size() / 3;
  std::vector<std::uint32_t> indices;
  std::size_t next_fine = 0, next_coarse = 0;
  while (next_fine < of_fine || next_coarse < of_coarse) {
    const bool is_fine = next_coarse == of_coarse || (next_fine < of_fine && indices.size() / 3 % 2 == 0);
    const std::size_t t = is_fine ? of_coarse + next_fine++ : next_coarse++;
    for (std::size_t k = 0; k < 3; ++k) indices.push_back(both.indices[3 * t + k]);
  }
  both.indices = std::move(indices);
  return sample_of(std::move(both));
}

}  // namespace

std::vector<HardCase> size_cases() {
  return {
      {.room = "sizes",
       .name = "strip",
       .parameter = "triangles",
       .sweep = {1, 2, 126, 127, 128, 129, 130, 255, 257},
       .is_whole = true,
       .is_quick = true,
       .make = strip},
      {.room = "sizes",
       .name = "one-group",
       .parameter = "cells along a face of a sphere, 12·n² triangles",
       .sweep = {1, 4, 9, 14, 15, 16},
       .is_whole = true,
       .is_quick = false,
       .make = lump},
      {.room = "sizes",
       .name = "valence",
       .parameter = "triangles around one vertex",
       .sweep = {3, 300, 10000, 100000},
       .is_whole = true,
       .is_quick = true,
       .make = fan},
      {.room = "sizes",
       .name = "loose",
       .parameter = "loose triangles",
       .sweep = {200, 10000, 100000},
       .is_quick = true,
       .make = loose},
      {.room = "sizes",
       .name = "interleaved",
       .parameter = "triangles, a fine and a coarse one in turns",
       .sweep = {10000},
       .is_whole = true,
       .is_quick = false,
       .make = interleaved},
      {.room = "sizes",
       .name = "interleaved-many",
       .parameter = "triangles, a fine and a coarse one in turns",
       .sweep = {45000},
       .is_whole = true,
       .is_quick = false,
       .make = interleaved},
      {.room = "sizes",
       .name = "unshared",
       .parameter = "triangles with vertices of their own",
       .sweep = {1024, 21824, 21888, 65536},
       .is_quick = false,
       .make = unshared},
  };
}

}  // namespace meshlode::test::hard
