// SPDX-License-Identifier: GPL-3.0-or-later
#include "layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

#include "shapes.h"

namespace meshlode::test {

namespace {

std::vector<Vec3d> normals_of(const Shape& shape) {
  std::vector<Vec3d> normals(shape.points.size(), Vec3d(0.0));
  for (const auto& [a, b, c] : shape.triangles) {
    const Vec3d n = glm::cross(shape.points[b] - shape.points[a], shape.points[c] - shape.points[a]);
    for (const std::uint32_t v : {a, b, c}) normals[v] += n;
  }
  for (Vec3d& n : normals) {
    const double square = glm::dot(n, n);
    n = square > 1e-60 ? n / std::sqrt(square) : Vec3d(0.0);
  }
  return normals;
}

/// Waves, so that there is something to simplify.
void ruffle(Shape& shape, Dice& dice) {
  const double height = dice.octaves(-9, -6);
  for (int i = 0; i < 4; ++i) {
    const Vec3d along = dice.direction() * dice.octaves(1, 4), up = dice.direction();
    for (Vec3d& p : shape.points) {
      double turn = glm::dot(p, along);
      turn -= std::floor(turn);
      p += up * (height * 16.0 * turn * turn * (1.0 - turn) * (1.0 - turn));
    }
  }
}

/// What of the shape lies on one side of one to three planes, `above` it.
Shape layer_of(const Shape& shape, const std::vector<Vec3d>& normals, double above, Dice& dice) {
  Shape out;
  struct Side {
    Vec3d through{0.0}, normal{0.0};
  };
  std::vector<Side> sides(dice.between(1, 3));
  for (Side& side : sides) {
    side.through = shape.points[dice.below(shape.points.size())];
    side.normal = dice.direction();
  }
  std::vector<std::uint32_t> copy(shape.points.size(), UINT32_MAX);
  for (const auto& triangle : shape.triangles) {
    const Vec3d middle =
        (shape.points[triangle[0]] + shape.points[triangle[1]] + shape.points[triangle[2]]) * (1.0 / 3.0);
    const bool is_in = std::all_of(sides.begin(), sides.end(), [&](const Side& side) {
      return glm::dot(middle - side.through, side.normal) > -0.2;
    });
    if (!is_in) continue;
    std::array<std::uint32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t& own = copy[triangle[k]];
      if (own == UINT32_MAX) own = out.add(shape.points[triangle[k]] + normals[triangle[k]] * above);
      corners[k] = own;
    }
    out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace

RandomScene layered_scene(Dice& dice, std::uint32_t triangles) {
  constexpr std::array<std::string_view, 4> kGood{"ball", "torus", "patch", "cylinder"};
  const std::string_view name = kGood[dice.below(kGood.size())];
  const auto kinds = shape_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const ShapeKind& k) { return k.name == name; });
  RandomScene scene;
  scene.contents = "layers of " + std::string(name);
  const std::uint32_t more = dice.between(1, 3);
  Shape shape = kind->make(dice, triangles / (1 + more));
  ruffle(shape, dice);
  const std::vector<Vec3d> normals = normals_of(shape);
  std::vector<Shape> layers{shape};
  double above = 0.0;
  for (std::uint32_t k = 0; k < more; ++k) {
    above += dice.octaves(-11, -5);
    layers.push_back(layer_of(shape, normals, above, dice));
  }
  // Turned by a quarter, mirrored, or as it is: all of them together.
  std::array<double, 16> common = RandomInstance().matrix;
  const std::uint64_t turn = dice.below(3);
  if (turn == 1) common = {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1};
  if (turn == 2) common[0] = -1.0;
  for (const Shape& layer : layers) {
    RandomMaterial material;
    material.is_double_sided = dice.chance(0.3);
    const double unit = std::ldexp(1.0, static_cast<int>(dice.below(9)) - 4);
    if (layer.triangles.empty()) continue;
    RandomPrimitive primitive;
    primitive.material = static_cast<std::uint32_t>(scene.materials.size());
    for (const Vec3d& p : layer.points) {
      Vec3f point;
      for (int k = 0; k < 3; ++k) point[k] = static_cast<float>(p[k] / unit);
      primitive.positions.push_back(point);
    }
    primitive.triangles = layer.triangles;
    RandomInstance instance;
    instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
    instance.matrix = common;
    for (std::size_t k = 0; k < 12; ++k) instance.matrix[k] *= unit;
    scene.materials.push_back(material);
    scene.instances.push_back(instance);
    scene.meshes.emplace_back().primitives.push_back(std::move(primitive));
  }
  return scene;
}

}  // namespace meshlode::test
