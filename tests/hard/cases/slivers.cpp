// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles that are hardly any: needles, caps, none at all, the same one again, and edges cut from one side only.
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/random.h"
#include "builder/odd_shapes.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

Result<Sample> needles(double aspect) {
  return sample_of(lab::make_slivers(2000, aspect));
}

/// A sheet whose cells each have a vertex that lies 1 / aspect off their diagonal: a cap on either side of it.
Result<Sample> caps(double aspect) {
  const std::uint32_t n = 24;
  scene::Primitive sheet =
      make_sheet(n, n, false, false, [](double u, double v) { return Vec3d(u, 0.05 * u * u, -v); });
  std::vector<std::uint32_t> indices;
  for (std::size_t t = 0; t + 5 < sheet.indices.size(); t += 6) {
    const std::uint32_t a = sheet.indices[t], b = sheet.indices[t + 1], c = sheet.indices[t + 2];
    const std::uint32_t d = sheet.indices[t + 5];
    const Vec3d pa = sheet.positions[a], pc = sheet.positions[c], pb = sheet.positions[b];
    const auto middle = static_cast<std::uint32_t>(sheet.positions.size());
    sheet.positions.push_back((pa + pc) * 0.5 + (pb - (pa + pc) * 0.5) * (1.0 / aspect));
    for (const std::uint32_t v : {a, b, middle, b, c, middle, c, a, middle, a, c, d}) indices.push_back(v);
  }
  sheet.indices = std::move(indices);
  return sample_of(std::move(sheet));
}

/// A lump in which a share of the triangles is there again: turned, the other way round, or without area.
Result<Sample> repeated(double share) {
  scene::Primitive shape = make_lump(12);
  const std::size_t count = shape.indices.size() / 3;
  SplitMix64 random(31);
  const auto extra = static_cast<std::size_t>(share * static_cast<double>(count));
  for (std::size_t i = 0; i < extra; ++i) {
    const std::size_t t = 3 * random.below(count);
    std::uint32_t a = shape.indices[t], b = shape.indices[t + 1], c = shape.indices[t + 2];
    if (i % 3 == 0) std::swap(b, c);
    if (i % 3 == 1) c = a;
    for (const std::uint32_t v : {b, c, a}) shape.indices.push_back(v);
  }
  return sample_of(std::move(shape));
}

/// Half a sheet has its edges along the middle cut in `pieces`, the other has not.
Result<Sample> t_junctions(double pieces) {
  const auto fine = static_cast<std::uint32_t>(pieces);
  const scene::Primitive left = make_sheet(12, 12, false, false, [](double u, double v) { return Vec3d(u, 0.0, -v); });
  const scene::Primitive right =
      make_sheet(12, 12 * fine, false, false, [](double u, double v) { return Vec3d(1.0 + u, 0.1 * u * u, -v); });
  return sample_of(joined(left, right));
}

Result<Sample> closed_t_junctions(double) {
  return sample_of(make_cube_with_t_junctions());
}

}  // namespace

std::vector<HardCase> sliver_cases() {
  return {
      {.room = "slivers",
       .name = "needles",
       .parameter = "length over width",
       .sweep = {1e1, 1e3, 1e5, 1e6, 1e9, 1e15},
       .is_quick = true,
       .make = needles},
      {.room = "slivers",
       .name = "caps",
       .parameter = "base over height",
       .sweep = {1e1, 1e3, 1e6, 1e9, 1e15},
       .is_quick = false,
       .make = caps},
      {.room = "slivers",
       .name = "repeated",
       .parameter = "triangles repeated, turned or without area, in shares of all",
       .sweep = {0.01, 0.1, 1.0, 10.0},
       .is_quick = false,
       .make = repeated},
      {.room = "slivers",
       .name = "t-junctions",
       .parameter = "edges against one edge across an open seam",
       .sweep = {2, 4, 16, 64},
       .is_whole = true,
       .is_quick = false,
       .make = t_junctions},
      {.room = "slivers",
       .name = "closed-t-junctions",
       .parameter = "-",
       .sweep = {1},
       .is_quick = true,
       .make = closed_t_junctions},
  };
}

}  // namespace meshlode::test::hard
