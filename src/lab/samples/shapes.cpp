// SPDX-License-Identifier: GPL-3.0-or-later
// Closed and open shapes of any resolution.
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "lab/samples/cube_grid.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::lab {

using namespace scene;

namespace {

/// A cube's surface lattice with shared vertices; `place` maps a lattice point in [-1, 1]^3 to its position.
template <class Place>
Primitive shared_cube(std::uint32_t n, const Place& place) {
  assert(n >= 1);
  Primitive out;
  std::map<std::tuple<int, int, int>, std::uint32_t> ids;
  for (int face = 0; face < 6; ++face) {
    for_each_cell(n, [&](std::uint32_t i, std::uint32_t j) {
      std::uint32_t corner[4];
      for (int k = 0; k < 4; ++k) {
        const Vec3i p = cube_lattice_point(face, i + kCellCorner[k][0], j + kCellCorner[k][1], n);
        const auto [at, is_new] = ids.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(out.positions.size()));
        if (is_new) out.positions.push_back(place(Vec3d(p) / static_cast<double>(n)));
        corner[k] = at->second;
      }
      add_quad(out.indices, corner[0], corner[1], corner[2], corner[3]);
    });
  }
  return out;
}

}  // namespace

Primitive make_sphere(std::uint32_t n, double radius) {
  return shared_cube(n, [&](const Vec3d& p) { return p * (radius / std::sqrt(glm::dot(p, p))); });
}

Primitive make_cube(std::uint32_t n, double half) {
  return shared_cube(n, [&](const Vec3d& p) { return p * half; });
}

Primitive make_torus(std::uint32_t major, std::uint32_t minor, double radius, double tube) {
  assert(major >= 3 && minor >= 3);
  Primitive out;
  for (std::uint32_t i = 0; i < major; ++i) {
    const double a = static_cast<double>(i) / major;
    for (std::uint32_t j = 0; j < minor; ++j) {
      const double b = static_cast<double>(j) / minor;
      const double r = radius + tube * cos_turns(b);
      out.positions.emplace_back(r * cos_turns(a), tube * sin_turns(b), -r * sin_turns(a));
    }
  }
  const auto id = [&](std::uint32_t i, std::uint32_t j) { return i % major * minor + j % minor; };
  for (std::uint32_t i = 0; i < major; ++i) {
    for (std::uint32_t j = 0; j < minor; ++j) {
      add_quad(out.indices, id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
    }
  }
  return out;
}

Primitive make_plane(std::uint32_t n, double half) {
  assert(n >= 1);
  Primitive out;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      out.positions.emplace_back((2.0 * i / n - 1.0) * half, 0.0, (1.0 - 2.0 * j / n) * half);
    }
  }
  for_each_cell(n, [&](std::uint32_t i, std::uint32_t j) {
    const std::uint32_t a = j * (n + 1) + i;
    add_quad(out.indices, a, a + 1, a + n + 2, a + n + 1);
  });
  return out;
}

Primitive scaled(Primitive shape, double factor) {
  for (Vec3d& p : shape.positions) p *= factor;
  return shape;
}

Primitive with_split_normals(const Primitive& shape) {
  Primitive out;
  out.material = shape.material;
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) {
    const Vec3d& a = shape.positions[shape.indices[t]];
    const Vec3d& b = shape.positions[shape.indices[t + 1]];
    const Vec3d& c = shape.positions[shape.indices[t + 2]];
    const Vec3d cross = glm::cross(b - a, c - a);
    const double length = std::sqrt(glm::dot(cross, cross));
    const Vec3f normal = length > 0.0 ? Vec3f(cross / length) : Vec3f(0.0F, 1.0F, 0.0F);
    for (const Vec3d* p : {&a, &b, &c}) {
      out.indices.push_back(static_cast<std::uint32_t>(out.positions.size()));
      out.positions.push_back(*p);
      out.normals.push_back(normal);
    }
  }
  return out;
}

Primitive with_smooth_normals(Primitive shape) {
  std::vector<Vec3d> sums(shape.positions.size(), Vec3d(0.0));
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) {
    const std::uint32_t* v = &shape.indices[t];
    const Vec3d cross =
        glm::cross(shape.positions[v[1]] - shape.positions[v[0]], shape.positions[v[2]] - shape.positions[v[0]]);
    for (int k = 0; k < 3; ++k) sums[v[k]] += cross;
  }
  shape.normals.clear();
  for (const Vec3d& s : sums) {
    const double length = std::sqrt(glm::dot(s, s));
    shape.normals.push_back(length > 0.0 ? Vec3f(s / length) : Vec3f(0.0F, 1.0F, 0.0F));
  }
  return shape;
}

SourceMesh as_mesh(Primitive shape, std::string name) {
  SourceMesh mesh;
  mesh.name = std::move(name);
  if (!shape.material.is_valid()) shape.material = MaterialId(0u);
  mesh.primitives.push_back(std::move(shape));
  return mesh;
}

Scene as_scene(SourceMesh mesh) {
  Scene scene;
  scene.source_name = mesh.name;
  scene.materials.emplace_back();
  SceneInstance instance;
  instance.name = mesh.name;
  instance.mesh = MeshId(0u);
  scene.instances.push_back(instance);
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

}  // namespace meshlode::lab
