// SPDX-License-Identifier: GPL-3.0-or-later
// Far from the origin: features of 1e-3 on a plane of side 1, the ways in which a scene may place them far away.
#include <algorithm>
#include <cmath>

#include "cases/shapes.h"
#include "hard_case.h"

namespace meshlode::test::hard {

namespace {

constexpr double kBump = 1e-3;
constexpr std::uint32_t kCells = 24;

const std::vector<double> kDistances{1e3, 1e5, 1e7, 1e9, 1e11, 1e13, 1e15};

Vec3d away(double distance) {
  return {distance, -0.75 * distance, 0.5 * distance};
}

/// As PLY and OBJ give them: the mesh's own coordinates are doubles far away.
Result<Sample> in_doubles(double distance) {
  Sample sample =
      sample_of(mapped(make_bumpy_plane(kCells, kBump), [&](const Vec3d& p) { return p + away(distance); }));
  sample.feature = kBump;
  // The sum itself is rounded to a double, before anything of ours sees it.
  sample.input_loss = std::sqrt(3.0) * std::ldexp(distance, -53);
  return sample;
}

/// As glTF gives them: the coordinates are floats, and have lost what floats lose there.
Result<Sample> in_floats(double distance) {
  const scene::Primitive near = make_bumpy_plane(kCells, kBump);
  Sample sample = sample_of(mapped(near, [&](const Vec3d& p) { return Vec3d(Vec3f(p + away(distance))); }));
  sample.feature = kBump;
  const auto& positions = sample.scene.meshes[0].primitives[0].positions;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3d moved = (positions[v] - away(distance)) - near.positions[v];
    sample.input_loss = std::max(sample.input_loss, std::sqrt(glm::dot(moved, moved)));
  }
  return sample;
}

/// By the transform of a node: the mesh stays near its own origin.
Result<Sample> by_a_node(double distance) {
  Sample sample = sample_of(make_bumpy_plane(kCells, kBump));
  sample.feature = kBump;
  const Vec3d to = away(distance);
  sample.scene.instances[0].transform[3] = {to.x, to.y, to.z, 1.0};
  return sample;
}

/// One vertex far away: the box grows with it, and the grid with the box.
Result<Sample> with_an_outlier(double distance) {
  scene::Primitive shape = make_bumpy_plane(kCells, kBump);
  const auto far = static_cast<std::uint32_t>(shape.positions.size());
  shape.positions.push_back(away(distance));
  for (const std::uint32_t v : {0U, 1U, far}) shape.indices.push_back(v);
  Sample sample = sample_of(std::move(shape));
  sample.feature = kBump;
  return sample;
}

}  // namespace

std::vector<HardCase> placement_cases() {
  return {
      {.room = "placement",
       .name = "far-doubles",
       .parameter = "distance of the mesh's coordinates, in its own size",
       .sweep = kDistances,
       .is_quick = true,
       .make = in_doubles},
      {.room = "placement",
       .name = "far-floats",
       .parameter = "distance, coordinates rounded to floats",
       .sweep = {1e0, 1e1, 1e2, 1e3, 1e5, 1e7, 1e9},
       .is_quick = false,
       .make = in_floats},
      {.room = "placement",
       .name = "far-node",
       .parameter = "distance of the node",
       .sweep = kDistances,
       .is_quick = false,
       .make = by_a_node},
      {.room = "placement",
       .name = "outlier",
       .parameter = "distance of one vertex from all others",
       .sweep = {1e0, 1e2, 1e4, 1e6, 1e9, 1e12, 1e37},
       .is_quick = true,
       .make = with_an_outlier},
  };
}

}  // namespace meshlode::test::hard
