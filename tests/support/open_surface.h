// SPDX-License-Identifier: GPL-3.0-or-later
// Random open surfaces whose borders meet themselves and each other: what is hard to simplify without opening a hole or
// making the border another one. On whole numbers, so that tests of the grid can take them as they are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"
#include "support/random.h"

namespace meshlode::test {

struct IntegerMesh {
  std::vector<Vec3i> positions;  ///< may have unused ones
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct OpenSurfaceOptions {
  std::uint32_t side = 12;           ///< cells of the sheet along x and z
  std::int32_t spacing = 40;         ///< of its vertices
  std::int32_t noise = 20;           ///< vertices are moved by less than this, on each axis
  std::uint32_t cell_holes = 0;      ///< per cent of the cells that are missing
  std::uint32_t triangle_holes = 0;  ///< per cent of the triangles that are missing
  std::uint32_t stars = 0;           ///< fans of triangles that meet in a vertex of the sheet and nowhere else
  std::uint32_t fins = 0;            ///< triangles on an edge that has two already
  std::uint32_t twins = 0;           ///< triangles there twice, half of them turned over
};

/// A sheet with all that. Cells left corner to corner pinch the border; so do stars.
[[nodiscard]] inline IntegerMesh make_open_surface(const OpenSurfaceOptions& options, Random& random) {
  IntegerMesh mesh;
  const std::uint32_t row = options.side + 1;
  const auto jitter = [&] {
    if (options.noise <= 0) return 0;
    return static_cast<int>(random.below(2 * static_cast<std::uint64_t>(options.noise) - 1)) - options.noise + 1;
  };
  for (std::uint32_t z = 0; z < row; ++z) {
    for (std::uint32_t x = 0; x < row; ++x) {
      mesh.positions.emplace_back(static_cast<int>(x) * options.spacing + jitter(), jitter(),
                                  static_cast<int>(z) * options.spacing + jitter());
    }
  }
  const auto missing = [&](std::uint32_t per_cent) { return random.below(100) < per_cent; };
  for (std::uint32_t z = 0; z < options.side; ++z) {
    for (std::uint32_t x = 0; x < options.side; ++x) {
      if (missing(options.cell_holes)) continue;
      const std::uint32_t a = z * row + x;
      const std::array<std::uint32_t, 3> lower{a, a + row, a + row + 1};
      const std::array<std::uint32_t, 3> upper{a, a + row + 1, a + 1};
      if (!missing(options.triangle_holes)) mesh.triangles.push_back(lower);
      if (!missing(options.triangle_holes)) mesh.triangles.push_back(upper);
    }
  }
  if (mesh.triangles.empty()) mesh.triangles.push_back({0, row, row + 1});
  const auto any_triangle = [&] { return mesh.triangles[random.below(mesh.triangles.size())]; };
  const auto near = [&](std::uint32_t vertex) {
    mesh.positions.push_back(mesh.positions[vertex] + Vec3i(2 * jitter(), options.spacing + jitter(), 2 * jitter()));
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  for (std::uint32_t i = 0; i < options.stars; ++i) {
    const std::uint32_t center = any_triangle()[0];
    const std::uint64_t rays = 2 + random.below(4);
    for (std::uint64_t k = 0; k < rays; ++k) mesh.triangles.push_back({center, near(center), near(center)});
  }
  for (std::uint32_t i = 0; i < options.fins; ++i) {
    const std::array<std::uint32_t, 3> base = any_triangle();
    mesh.triangles.push_back({base[1], base[0], near(base[0])});
  }
  for (std::uint32_t i = 0; i < options.twins; ++i) {
    std::array<std::uint32_t, 3> twin = any_triangle();
    if (random.below(2) == 0) std::swap(twin[1], twin[2]);
    mesh.triangles.push_back(twin);
  }
  return mesh;
}

/// Options of any kind, small enough for a thousand of them.
[[nodiscard]] inline OpenSurfaceOptions random_surface_options(Random& random, std::uint32_t max_side) {
  OpenSurfaceOptions options;
  options.side = 2 + static_cast<std::uint32_t>(random.below(max_side - 1));
  // Down to the grid itself: there vertices come to lie on each other.
  constexpr std::int32_t kSpacings[] = {1, 2, 5, 40, 1000};
  options.spacing = kSpacings[random.below(5)];
  options.noise = static_cast<std::int32_t>(random.below(static_cast<std::uint64_t>(options.spacing) + 1));
  constexpr std::uint32_t kShares[] = {0, 5, 20, 40, 60};
  options.cell_holes = kShares[random.below(5)];
  options.triangle_holes = kShares[random.below(3)];
  const auto some = [&] {
    return random.below(2) == 0 ? 0U : static_cast<std::uint32_t>(random.below(2 * options.side));
  };
  options.stars = some();
  options.fins = some();
  options.twins = some();
  return options;
}

[[nodiscard]] inline scene::Primitive as_primitive(const IntegerMesh& mesh, double unit = 1.0) {
  scene::Primitive shape;
  for (const Vec3i& p : mesh.positions) shape.positions.push_back(Vec3d(p) * unit);
  for (const auto& t : mesh.triangles) shape.indices.insert(shape.indices.end(), t.begin(), t.end());
  return shape;
}

}  // namespace meshlode::test
