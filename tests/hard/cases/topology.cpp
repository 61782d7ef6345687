// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that are no manifolds, or no orientable ones.
#include <cmath>
#include <cstddef>
#include <utility>

#include "builder/odd_shapes.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

/// `sheets` half planes around one line, like the pages of an open book: an edge of that many triangles.
Result<Sample> book(double sheets) {
  scene::Primitive shape;
  const std::uint32_t n = 16;
  const auto pages = static_cast<std::uint32_t>(sheets);
  for (std::uint32_t page = 0; page < pages; ++page) {
    const double turn = static_cast<double>(page) / pages;
    const scene::Primitive one = make_sheet(n, n, false, false, [&](double u, double v) {
      return Vec3d(u * lab::cos_turns(turn), u * lab::sin_turns(turn), v);  // u = 0: the same bits in every page
    });
    shape = page == 0 ? one : joined(shape, one);
  }
  return sample_of(std::move(shape));
}

/// So many closed bodies that meet in one vertex.
Result<Sample> pinched(double bodies) {
  scene::Primitive shape;
  const auto count = static_cast<std::uint32_t>(bodies);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double turn = static_cast<double>(i) / count;
    const double size = 1.0 / count;
    // A body whose vertex 0 is moved to the origin, which all share.
    scene::Primitive body = mapped(lab::make_sphere(6, size), [&](const Vec3d& p) {
      return p + Vec3d(2.0 * lab::cos_turns(turn), 2.0 * lab::sin_turns(turn), 0.0);
    });
    body.positions[0] = Vec3d(0.0);
    shape = i == 0 ? body : joined(shape, body);
  }
  return sample_of(std::move(shape));
}

Result<Sample> moebius(double around) {
  return sample_of(lab::make_moebius(static_cast<std::uint32_t>(around), 8));
}

Result<Sample> klein(double around) {
  Sample sample = sample_of(make_klein(static_cast<std::uint32_t>(around)));
  return sample;
}

/// Every triangle the other way round with this probability, of a closed surface.
Result<Sample> mixed_winding(double share) {
  scene::Primitive shape = make_lump(12);
  const std::size_t every = static_cast<std::size_t>(1.0 / share + 0.5);
  for (std::size_t t = 0; 3 * t + 2 < shape.indices.size(); t += every) {
    std::swap(shape.indices[3 * t + 1], shape.indices[3 * t + 2]);
  }
  return sample_of(std::move(shape));
}

/// Loose handles: a closed surface of that genus, tori side by side in a row, joined by nothing.
Result<Sample> holes(double count) {
  scene::Primitive shape;
  const auto handles = static_cast<std::uint32_t>(count);
  for (std::uint32_t i = 0; i < handles; ++i) {
    const scene::Primitive torus = mapped(lab::make_torus(12, 6, 1.0, 0.3),
                                          [&](const Vec3d& p) { return p + Vec3d(1.5 * i, 0.0, 0.1 * (i % 2)); });
    shape = i == 0 ? torus : joined(shape, torus);
  }
  Sample sample = sample_of(std::move(shape));
  sample.crosses_itself = handles > 1;
  return sample;
}

}  // namespace

std::vector<HardCase> topology_cases() {
  return {
      {.room = "topology",
       .name = "book",
       .parameter = "triangles at each edge of one line",
       .sweep = {2, 3, 8, 64},
       .is_whole = true,
       .is_quick = true,
       .make = book},
      {.room = "topology",
       .name = "pinched",
       .parameter = "closed bodies that meet in one vertex",
       .sweep = {1, 2, 16, 64},
       .is_whole = true,
       .is_quick = true,
       .make = pinched},
      {.room = "topology",
       .name = "moebius",
       .parameter = "cells around",
       .sweep = {3, 30, 300},
       .is_whole = true,
       .is_quick = true,
       .make = moebius},
      {.room = "topology",
       .name = "klein",
       .parameter = "cells around and across",
       .sweep = {6, 24, 64},
       .is_whole = true,
       .is_quick = true,
       .make = klein},
      {.room = "topology",
       .name = "mixed-winding",
       .parameter = "share of triangles the other way round",
       .sweep = {0.01, 0.1, 0.5},
       .is_quick = false,
       .make = mixed_winding},
      {.room = "topology",
       .name = "rings",
       .parameter = "rings through each other",
       .sweep = {1, 8, 64},
       .is_whole = true,
       .is_quick = false,
       .make = holes},
  };
}

}  // namespace meshlode::test::hard
