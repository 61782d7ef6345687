// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/plate_scene.h"

#include <array>

namespace meshlode::test {

namespace {

constexpr double kWidth = 100.0, kHeight = 60.0, kDepth = 20.0;

void add_quad(const std::array<Vec3d, 4>& corners, scene::Primitive& out) {
  const auto first = static_cast<std::uint32_t>(out.positions.size());
  out.positions.insert(out.positions.end(), corners.begin(), corners.end());
  for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) out.indices.push_back(first + k);
}

/// A closed surface over cells of a grid in x and y: fronts at front(cell), backs at `back`, and walls where they end
/// or step.
template <class Front>
scene::Primitive make_steps(std::uint32_t columns, std::uint32_t rows, const Vec3d& low, double cell, double back,
                            const Front& front) {
  scene::Primitive out;
  const auto at = [&](std::uint32_t i, std::uint32_t j, double z) { return low + Vec3d(i * cell, j * cell, z); };
  const auto height = [&](std::int64_t i, std::int64_t j) {
    const bool is_inside = i >= 0 && j >= 0 && i < columns && j < rows;
    return is_inside ? front(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j)) : back;
  };
  // A wall below the edge from p to q of the higher side, which has it on its left.
  const auto add_wall = [&](const Vec3d& p, const Vec3d& q, double lower) {
    if (p.z > lower) add_quad({p, {p.x, p.y, low.z + lower}, {q.x, q.y, low.z + lower}, q}, out);
  };
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const double z = height(i, j);
      add_quad({at(i, j, z), at(i + 1, j, z), at(i + 1, j + 1, z), at(i, j + 1, z)}, out);
      add_quad({at(i, j, back), at(i, j + 1, back), at(i + 1, j + 1, back), at(i + 1, j, back)}, out);
      const std::int64_t x = i, y = j;
      if (z > height(x, y - 1)) add_wall(at(i, j, z), at(i + 1, j, z), height(x, y - 1));
      if (z > height(x + 1, y)) add_wall(at(i + 1, j, z), at(i + 1, j + 1, z), height(x + 1, y));
      if (z > height(x, y + 1)) add_wall(at(i + 1, j + 1, z), at(i, j + 1, z), height(x, y + 1));
      if (z > height(x - 1, y)) add_wall(at(i, j + 1, z), at(i, j, z), height(x - 1, y));
    }
  }
  return out;
}

}  // namespace

scene::Scene plate_scene(const PlateSceneOptions& options) {
  scene::Scene scene;
  scene.source_name = "plate.glb";
  scene.source_hash = "00000000000000000000000000000000";
  scene.document = R"({"asset":{"version":"2.0"},"materials":[{"name":"wood"},{"name":"brass"}]})";
  scene.materials.resize(2);
  for (std::uint32_t m = 0; m < 2; ++m) scene.materials[m].source_index = m;

  const std::uint32_t columns = options.cells, rows = options.cells * 3 / 5;
  const double cell = kWidth / columns;
  const auto is_recess = [&](std::uint32_t i, std::uint32_t j) {
    return i >= columns / 5 && i < columns - columns / 5 && j >= rows / 3 && j < rows - rows / 3;
  };
  scene.meshes.resize(2);
  scene.meshes[0].name = "block";
  scene.meshes[0].primitives = {
      make_steps(columns, rows, Vec3d(0.0), cell, -kDepth,
                 [&](std::uint32_t i, std::uint32_t j) { return is_recess(i, j) ? -kRecessDepth : 0.0; })};
  const Vec3d corner(columns / 5 * cell + 1.0, rows / 3 * cell + 1.0, 0.0);  // 1 mm of floor is seen around the plate
  const double width = kWidth - 2.0 * corner.x, height = kHeight - 2.0 * corner.y;
  scene.meshes[1].name = "plate";
  scene.meshes[1].primitives = {make_steps(1, 1, Vec3d(0.0), 1.0, kPlateBack,
                                           [](std::uint32_t, std::uint32_t) { return kPlateBack + kPlateThickness; })};
  for (Vec3d& p : scene.meshes[1].primitives[0].positions) {
    p = corner + Vec3d(p.x * width, p.y * height, p.z) + options.plate_moved;
  }
  if (!options.has_plate) scene.meshes[1].primitives[0].indices.clear();
  for (std::uint32_t m = 0; m < 2; ++m) {
    scene.meshes[m].primitives[0].material = MaterialId(options.are_materials_swapped ? 1 - m : m);
    scene::SceneInstance& instance = scene.instances.emplace_back();
    instance.name = scene.meshes[m].name;
    instance.node = m;
    instance.mesh = MeshId(m);
  }
  return scene;
}

}  // namespace meshlode::test
