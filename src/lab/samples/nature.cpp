// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of data/: a rock, a terrain, crystals and foliage.
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>

#include "base/random.h"
#include "lab/samples/cube_grid.h"
#include "lab/samples/facets.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {

using namespace scene;

namespace {

/// Vertex normals summed by position, so that they agree across UV seams.
void smooth_by_position(Primitive& shape) {
  using Key = std::tuple<double, double, double>;
  std::map<Key, Vec3d> sums;
  const auto key = [&](std::uint32_t v) {
    const Vec3d& p = shape.positions[v];
    return Key{p.x, p.y, p.z};
  };
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) {
    const std::uint32_t* v = &shape.indices[t];
    const Vec3d cross =
        glm::cross(shape.positions[v[1]] - shape.positions[v[0]], shape.positions[v[2]] - shape.positions[v[0]]);
    for (int k = 0; k < 3; ++k) {
      Vec3d& sum = sums.try_emplace(key(v[k]), 0.0).first->second;
      sum += cross;
    }
  }
  shape.normals.clear();
  for (std::uint32_t v = 0; v < shape.positions.size(); ++v) shape.normals.emplace_back(unit(sums.at(key(v))));
}

double rock_radius(const Vec3d& direction, std::uint64_t seed) {
  // Ridges (folded noise) over a lumpy body, and flat planes cut off as if broken.
  double radius = 1.0 + 0.35 * fractal_noise(direction * 1.5, 3, seed);
  const double fold = fractal_noise(direction * 3.0, 5, seed + 100);
  radius += 0.18 * (0.5 - (fold < 0.0 ? -fold : fold));
  SplitMix64 random(seed + 200);
  for (int i = 0; i < 7; ++i) {
    const double x = random.between(-1.0, 1.0), y = random.between(-1.0, 1.0), z = random.between(-1.0, 1.0);
    const Vec3d normal = unit(Vec3d(x, y, z) + Vec3d(1e-3));
    const double along = glm::dot(normal, direction);
    if (along > 0.0 && radius * along > 0.95) radius = 0.95 / along;
  }
  return radius + 0.01 * fractal_noise(direction * 24.0, 2, seed + 300);
}

}  // namespace

Primitive make_rock(std::uint32_t n, std::uint64_t seed) {
  assert(n >= 1);
  Primitive out;
  for (int face = 0; face < 6; ++face) {
    const auto first = static_cast<std::uint32_t>(out.positions.size());
    for (std::uint32_t j = 0; j <= n; ++j) {
      for (std::uint32_t i = 0; i <= n; ++i) {
        const Vec3d direction = unit(Vec3d(cube_lattice_point(face, i, j, n)));
        out.positions.push_back(direction * rock_radius(direction, seed));
        // Six charts in a 3 × 2 atlas with a small margin, so that charts do not touch.
        const auto column = face % 3, row = face / 3;
        const double u = (column + 0.02 + 0.96 * i / n) / 3.0, v = (row + 0.02 + 0.96 * j / n) / 2.0;
        out.uvs[0].emplace_back(static_cast<float>(u), static_cast<float>(v));
      }
    }
    for_each_cell(n, [&](std::uint32_t i, std::uint32_t j) {
      const std::uint32_t a = first + j * (n + 1) + i;
      add_quad(out.indices, a, a + 1, a + n + 2, a + n + 1);
    });
  }
  smooth_by_position(out);
  return out;
}

Primitive make_terrain(std::uint32_t columns, std::uint32_t rows, std::uint64_t seed) {
  assert(columns >= 1 && rows >= 1);
  Primitive out;
  const double size = 100.0;  // length of the longer side
  const double cell = size / (columns > rows ? columns : rows);
  const auto height = [&](double x, double z) {
    const Vec3d p(x / size * 6.0, 0.5, z / size * 6.0);
    const double ridge = fractal_noise(p, 7, seed);
    const double valley = fractal_noise(p * 0.5, 3, seed + 50);
    return 14.0 * (valley + 0.6 * (0.5 - (ridge < 0.0 ? -ridge : ridge)));
  };
  for (std::uint32_t j = 0; j <= rows; ++j) {
    for (std::uint32_t i = 0; i <= columns; ++i) {
      const double x = (i - 0.5 * columns) * cell, z = (0.5 * rows - j) * cell;
      out.positions.emplace_back(x, height(x, z), z);
      const double d = 0.5 * cell;
      const double dx = height(x + d, z) - height(x - d, z), dz = height(x, z + d) - height(x, z - d);
      out.normals.emplace_back(unit(Vec3d(-dx, 2.0 * d, -dz)));
      out.uvs[0].emplace_back(static_cast<float>(8.0 * i / columns), static_cast<float>(8.0 * j / rows));
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * (columns + 1) + i;
      add_quad(out.indices, a, a + 1, a + columns + 2, a + columns + 1);
    }
  }
  return out;
}

Primitive make_crystal(std::uint32_t crystals, std::uint32_t n, std::uint64_t seed) {
  assert(n >= 1);
  Primitive out;
  FacetBuilder facets{out};
  SplitMix64 random(seed);
  for (std::uint32_t k = 0; k < crystals; ++k) {
    const double x = random.between(-1.0, 1.0), y = random.between(0.15, 1.0), z = random.between(-1.0, 1.0);
    const Vec3d axis = unit({x, y, z});
    const double helper_y = axis.y > 0.9 ? 0.0 : 1.0;
    const Vec3d side = unit(glm::cross(Vec3d(1.0 - helper_y, helper_y, 0.0), axis));
    const Vec3d front = glm::cross(axis, side);
    const double radius = random.between(0.10, 0.22), length = random.between(0.7, 1.6), tip = random.between(0.2, 0.4);
    // A double-ended prism: start tip, ring, ring, end tip. Each ring corner has its own radius.
    Vec3d low[6], high[6];
    for (int c = 0; c < 6; ++c) {
      const double r = radius * random.between(0.8, 1.2);
      const Vec3d out_there = side * (r * cos_turns(c / 6.0)) + front * (r * sin_turns(c / 6.0));
      low[c] = out_there;
      high[c] = out_there + axis * length;
    }
    const Vec3d start = -axis * tip * 0.5, end = axis * (length + tip);
    for (int c = 0; c < 6; ++c) {
      const int d = (c + 1) % 6;
      // Neighbouring facets evaluate a shared side in opposite directions; mix() gives both the same bits.
      facets.quad(low[c], low[d], high[d], high[c], n, 4 * n);
      facets.triangle(high[c], high[d], end, n);
      facets.triangle(low[d], low[c], start, n);
    }
  }
  return out;
}

Primitive make_foliage(std::uint32_t count, std::uint64_t seed) {
  Primitive out;
  SplitMix64 random(seed);
  for (std::uint32_t k = 0; k < count; ++k) {
    const double x = random.between(-10.0, 10.0), z = random.between(-10.0, 10.0);
    const double turn = random.unit(), lean = random.between(-0.35, 0.35);
    const double width = random.between(0.15, 0.4), height = random.between(0.4, 1.2);
    const Vec3d side(cos_turns(turn), 0.0, sin_turns(turn));
    const Vec3d up = unit(Vec3d(-side.z * lean, 1.0, side.x * lean));
    add_card(out, Vec3d(x, 0.0, z), side * width, up * height, Vec3f(unit(glm::cross(side, up))));
  }
  return out;
}

}  // namespace meshlode::lab
