// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes on which mesh programs break: loose, thin, non-manifold, degenerate, repeated, not orientable, far away.
#include <cassert>
#include <cmath>

#include "base/random.h"
#include "lab/samples/cube_grid.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {

using namespace scene;

namespace {

std::uint32_t add_vertex(Primitive& out, const Vec3d& p) {
  out.positions.push_back(p);
  return static_cast<std::uint32_t>(out.positions.size() - 1);
}

void add_triangle(Primitive& out, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  out.indices.insert(out.indices.end(), {a, b, c});
}

void append(Primitive& out, const Primitive& piece, const Vec3d& scale, const Vec3d& offset) {
  const auto base = static_cast<std::uint32_t>(out.positions.size());
  for (const Vec3d& p : piece.positions) out.positions.push_back(p * scale + offset);
  for (const std::uint32_t i : piece.indices) out.indices.push_back(base + i);
}

Vec3d random_vector(SplitMix64& random, double low, double high) {
  const double x = random.between(low, high);
  const double y = random.between(low, high);
  const double z = random.between(low, high);
  return {x, y, z};
}

}  // namespace

Primitive make_box_soup(std::uint32_t count, std::uint64_t seed) {
  Primitive out;
  SplitMix64 random(seed);
  const Primitive box = make_cube(1, 0.5);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d size = random_vector(random, 0.05, 0.6);
    append(out, box, size, random_vector(random, -5.0, 5.0));
  }
  return out;
}

Primitive make_loose_pieces(std::uint32_t count, std::uint64_t seed) {
  Primitive out;
  SplitMix64 random(seed);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d at = random_vector(random, -5.0, 5.0);
    std::uint32_t last[2] = {add_vertex(out, at), add_vertex(out, at + random_vector(random, -0.2, 0.2))};
    const std::uint32_t triangles = 1 + random.scaled_below(3);
    for (std::uint32_t t = 0; t < triangles; ++t) {
      const std::uint32_t next = add_vertex(out, at + random_vector(random, -0.2, 0.2));
      if (t % 2 == 0) {
        add_triangle(out, last[0], last[1], next);
      } else {
        add_triangle(out, last[1], last[0], next);
      }
      last[0] = last[1];
      last[1] = next;
    }
  }
  return out;
}

Primitive make_blade(std::uint32_t n, double thickness) {
  Primitive out = make_plane(n, 1.0);
  const auto sheet = static_cast<std::uint32_t>(out.positions.size());
  const std::size_t sheet_indices = out.indices.size();
  for (std::uint32_t i = 0; i < sheet; ++i) {
    Vec3d& top = out.positions[i];
    top = {top.x, 0.5 * thickness, 0.5 * top.z};
    out.positions.emplace_back(out.positions[i].x, -0.5 * thickness, out.positions[i].z);
  }
  for (std::size_t t = 0; t < sheet_indices; t += 3) {
    add_triangle(out, out.indices[t] + sheet, out.indices[t + 2] + sheet, out.indices[t + 1] + sheet);
  }
  // The rim: every border edge a → b of the top sheet gets a quad down to the bottom sheet.
  for_each_rim_edge(n, [&](std::uint32_t a, std::uint32_t b) { add_quad(out.indices, b, a, a + sheet, b + sheet); });
  return out;
}

Primitive make_three_sheets(std::uint32_t n) {
  assert(n >= 1);
  Primitive out;
  for (std::uint32_t j = 0; j <= n; ++j) add_vertex(out, {0.0, 0.0, static_cast<double>(j) / n});
  for (int sheet = 0; sheet < 3; ++sheet) {
    const double x = cos_turns(sheet / 3.0), y = sin_turns(sheet / 3.0);
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (std::uint32_t i = 1; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= n; ++j) {
        const double r = static_cast<double>(i) / n;
        add_vertex(out, {r * x, r * y, static_cast<double>(j) / n});
      }
    }
    const auto id = [&](std::uint32_t i, std::uint32_t j) { return i == 0 ? j : first + (i - 1) * (n + 1) + j; };
    for_each_cell(n, [&](std::uint32_t i, std::uint32_t j) {
      add_quad(out.indices, id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
    });
  }
  return out;
}

Primitive make_double_cone(std::uint32_t segments) {
  assert(segments >= 3);
  Primitive out;
  const std::uint32_t tip = add_vertex(out, Vec3d(0.0));
  for (const double side : {1.0, -1.0}) {
    const auto ring = static_cast<std::uint32_t>(out.positions.size());
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double a = side * static_cast<double>(i) / segments;
      add_vertex(out, {cos_turns(a), side, -sin_turns(a)});
    }
    const std::uint32_t center = add_vertex(out, {0.0, side, 0.0});
    for (std::uint32_t i = 0; i < segments; ++i) {
      const std::uint32_t a = ring + i, b = ring + (i + 1) % segments;
      add_triangle(out, center, a, b);  // the cap, away from the tip
      add_triangle(out, tip, b, a);
    }
  }
  return out;
}

Primitive make_slivers(std::uint32_t count, double aspect) {
  assert(count >= 1);
  Primitive out;
  const double width = 1.0 / aspect;
  for (std::uint32_t i = 0; i < count + 2; ++i) {
    add_vertex(out, {i % 2 == 0 ? 0.0 : 1.0, 0.0, -width * i});
    if (i < 2) continue;
    if (i % 2 == 0) {
      add_triangle(out, i - 2, i - 1, i);
    } else {
      add_triangle(out, i - 1, i - 2, i);
    }
  }
  return out;
}

Primitive make_duplicates(std::uint32_t n) {
  Primitive out = make_sphere(n);
  const std::size_t count = out.indices.size() / 3;
  for (std::size_t t = 0; t < count; t += 3) {
    add_triangle(out, out.indices[3 * t + 1], out.indices[3 * t + 2], out.indices[3 * t]);
  }
  return out;
}

Primitive make_zero_areas(std::uint32_t n) {
  Primitive out = make_sphere(n);
  const std::size_t count = out.indices.size() / 3;
  for (std::size_t t = 0; t < count; t += 10) {
    const std::uint32_t a = out.indices[3 * t], b = out.indices[3 * t + 1];
    switch (t / 10 % 3) {
      case 0: add_triangle(out, a, b, b); break;
      case 1: {
        const Vec3d same = out.positions[a];
        add_triangle(out, a, b, add_vertex(out, same));
        break;
      }
      default: {
        // Exactly collinear: all three on one axis-parallel line with dyadic coordinates.
        const std::uint32_t p = add_vertex(out, {2.0, 0.25, 0.0});
        const std::uint32_t q = add_vertex(out, {2.0, 0.5, 0.0});
        add_triangle(out, p, q, add_vertex(out, {2.0, 1.0, 0.0}));
      }
    }
  }
  return out;
}

Primitive make_moebius(std::uint32_t n, std::uint32_t m) {
  assert(n >= 3 && m >= 1);
  Primitive out;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = static_cast<double>(i) / n;
    for (std::uint32_t j = 0; j <= m; ++j) {
      const double w = 0.4 * (2.0 * j / m - 1.0);
      const double r = 1.0 + w * cos_turns(0.5 * a);
      add_vertex(out, {r * cos_turns(a), w * sin_turns(0.5 * a), -r * sin_turns(a)});
    }
  }
  // After one turn the strip meets itself upside down.
  const auto id = [&](std::uint32_t i, std::uint32_t j) { return i < n ? i * (m + 1) + j : m - j; };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      add_quad(out.indices, id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
    }
  }
  return out;
}

Primitive make_far_plane(std::uint32_t n) {
  Primitive out = make_plane(n, 0.5);
  for (Vec3d& p : out.positions) p = Vec3d(1e6) + Vec3d(p.x, 1e-3 * value_noise(p * 16.0, 1), p.z);
  return out;
}

}  // namespace meshlode::lab
