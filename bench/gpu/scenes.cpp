// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes.h"

#include <algorithm>
#include <cmath>

namespace meshlode::bench {

namespace {

struct MeshBox {
  Vec3d center{0.0};
  double low_y = 0.0, diagonal = 1.0;
};

MeshBox box_of(const format::MeshRecord& mesh) {
  const double step = std::ldexp(static_cast<double>(mesh.grid.mantissa), mesh.grid.log2);
  Vec3d low{0.0}, high{0.0};
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = mesh.origin[axis] + step * mesh.bounds_min[axis];
    high[axis] = mesh.origin[axis] + step * mesh.bounds_max[axis];
  }
  return {0.5 * (low + high), low.y, glm::length(high - low)};
}

/// Turned about y by a rotation that needs no library's bits, moved so that the mesh's middle is at `place`.
format::InstanceRecord place_mesh(const MeshBox& box, const Vec3d& place, std::uint64_t seed) {
  const double t = static_cast<double>(seed * 0x9E3779B97F4A7C15ull >> 11) * 0x1p-53 * 2.0 - 1.0;
  const double c = (1.0 - t * t) / (1.0 + t * t), s = 2.0 * t / (1.0 + t * t);
  format::InstanceRecord out{};
  const double rows[3][3] = {{c, 0.0, s}, {0.0, 1.0, 0.0}, {-s, 0.0, c}};
  for (int row = 0; row < 3; ++row) {
    double moved = place[row];
    for (int k = 0; k < 3; ++k) {
      out.transform[4 * row + k] = rows[row][k];
      moved -= rows[row][k] * box.center[k];
    }
    out.transform[4 * row + 3] = moved;
  }
  out.scale = 1.0 + 1e-15;
  return out;
}

}  // namespace

BenchScene make_grid(const run::Asset& asset, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  const MeshBox box = box_of(asset.meshes()[0]);
  BenchScene scene;
  scene.diagonal = box.diagonal;
  const double spacing = box.diagonal;
  for (std::uint32_t k = 0; k < z; ++k) {
    for (std::uint32_t j = 0; j < y; ++j) {
      for (std::uint32_t i = 0; i < x; ++i) {
        const Vec3d place(spacing * (i - 0.5 * (x - 1.0)), spacing * (j - 0.5 * (y - 1.0)),
                          spacing * (k - 0.5 * (z - 1.0)));
        scene.instances.push_back(place_mesh(box, place, scene.instances.size() + 1));
      }
    }
  }
  scene.radius = 0.5 * spacing * std::sqrt(1.0 * x * x + 1.0 * y * y + 1.0 * z * z);
  return scene;
}

BenchScene make_ground(const run::Asset& asset, std::uint32_t side) {
  const MeshBox box = box_of(asset.meshes()[0]);
  BenchScene scene;
  scene.is_ground = true;
  scene.diagonal = box.diagonal;
  const double spacing = box.diagonal;
  for (std::uint32_t k = 0; k < side; ++k) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const Vec3d place(spacing * (i - 0.5 * (side - 1.0)), box.center.y - box.low_y, -spacing * k);
      scene.instances.push_back(place_mesh(box, place, scene.instances.size() + 1));
    }
  }
  scene.center = {0.0, 0.0, -0.5 * spacing * side};
  scene.radius = spacing * side;
  return scene;
}

run::Camera bench_camera(const BenchScene& scene, double t, std::uint32_t width, std::uint32_t height) {
  run::Camera camera;
  camera.width = width;
  camera.height = height;
  camera.near_distance = 0.02 * scene.diagonal;
  if (scene.is_ground) {
    camera.eye = Vec3d(scene.diagonal * (4.0 * t - 2.0), 2.5 * scene.diagonal, 4.0 * scene.diagonal);
    camera.target = camera.eye + Vec3d(0.3 * (t - 0.5), -0.12, -1.0);
    return camera;
  }
  const double angle = 6.283185307179586 * t + 0.6;
  const double distance = scene.instances.size() == 1 ? 1.3 * scene.diagonal : 1.9 * scene.radius;
  camera.eye = scene.center + distance * Vec3d(std::sin(angle) * 0.9, 0.42, std::cos(angle) * 0.9);
  camera.target = scene.center;
  return camera;
}

}  // namespace meshlode::bench
