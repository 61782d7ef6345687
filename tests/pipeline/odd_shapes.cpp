// SPDX-License-Identifier: GPL-3.0-or-later
#include "odd_shapes.h"

#include "samples/noise.h"
#include "samples/samples.h"

namespace meshlode::test {

Primitive make_fan(std::uint32_t valence) {
  Primitive fan;
  fan.positions.emplace_back(0.0, 0.25, 0.0);
  for (std::uint32_t i = 0; i < valence; ++i) {
    const double turns = static_cast<double>(i) / valence;
    fan.positions.emplace_back(samples::cos_turns(turns), 0.0, -samples::sin_turns(turns));
    fan.indices.insert(fan.indices.end(), {0U, i + 1, (i + 1) % valence + 1});
  }
  fan.material = MaterialId(0U);
  return fan;
}

Primitive make_triangle() {
  Primitive triangle;
  triangle.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  triangle.indices = {0, 1, 2};
  triangle.material = MaterialId(0U);
  return triangle;
}

Primitive make_identical(std::uint32_t count) {
  Primitive shape = make_triangle();
  for (std::uint32_t i = 1; i < count; ++i)
    shape.indices.insert(shape.indices.end(), {i % 3, (i + 1) % 3, (i + 2) % 3});
  return shape;
}

Scene make_striped_plane(std::uint32_t n, std::uint32_t materials) {
  const Primitive plane = samples::make_plane(n);
  Scene scene;
  SourceMesh& mesh = scene.meshes.emplace_back();
  mesh.name = "stripes";
  const std::size_t triangles = plane.indices.size() / 3;
  for (std::uint32_t m = 0; m < materials; ++m) {
    Primitive& stripe = mesh.primitives.emplace_back(plane);
    stripe.indices.clear();
    for (std::size_t t = m * triangles / materials; t < (m + 1) * triangles / materials; ++t) {
      for (std::size_t k = 0; k < 3; ++k) stripe.indices.push_back(plane.indices[3 * t + k]);
    }
    stripe.material = MaterialId(m);
    scene.materials.emplace_back().source_index = m;
  }
  SceneInstance& instance = scene.instances.emplace_back();
  instance.mesh = MeshId(0U);
  return scene;
}

Primitive make_coincident_spheres(std::uint32_t n, std::uint32_t sheets) {
  const Primitive sphere = samples::make_sphere(n);
  Primitive shape = sphere;
  for (std::uint32_t s = 1; s < sheets; ++s) {
    const auto base = static_cast<std::uint32_t>(shape.positions.size());
    shape.positions.insert(shape.positions.end(), sphere.positions.begin(), sphere.positions.end());
    for (const std::uint32_t i : sphere.indices) shape.indices.push_back(base + i);
  }
  // Normals that differ between the sheets, or prepare would rightly call them duplicates.
  for (std::uint32_t s = 0; s < sheets; ++s) {
    for (const Vec3d& p : sphere.positions) {
      Vec3d normal = p;
      normal.x += 0.25 * s;
      shape.normals.emplace_back(glm::normalize(normal));
    }
  }
  return shape;
}

Primitive make_line_of_triangles(std::uint32_t count) {
  samples::Random random(17);
  Primitive shape;
  for (std::uint32_t i = 0; i < 3 * count; ++i) {
    const double t = random.unit();
    shape.positions.emplace_back(t, 2.0 * t, -t);  // exactly collinear: powers of two times t
    shape.indices.push_back(i);
  }
  shape.material = MaterialId(0U);
  return shape;
}

Primitive make_cards(std::uint32_t count, std::uint64_t seed) {
  samples::Random random(seed);
  const auto vector = [&](double size) {
    Vec3d v;
    for (int k = 0; k < 3; ++k) v[k] = size * (2.0 * random.below(1U << 20U) / (1U << 20U) - 1.0);
    return v;
  };
  Primitive shape;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d center = vector(10.0), u = vector(0.2), v = vector(0.2);
    const std::uint32_t first = 4 * i;
    for (const Vec3d& corner : {-u - v, u - v, u + v, v - u}) shape.positions.push_back(center + corner);
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) shape.indices.push_back(first + k);
  }
  shape.material = MaterialId(0U);
  return shape;
}

Primitive make_lattice_chaos(std::uint32_t count, std::uint32_t side, std::uint64_t seed) {
  samples::Random random(seed);
  Primitive shape;
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) shape.positions.emplace_back(x, y, z);
    }
  }
  const std::uint32_t points = side * side * side;
  for (std::uint32_t i = 0; i < 3 * count; ++i) shape.indices.push_back(random.below(points));
  shape.material = MaterialId(0U);
  return shape;
}

}  // namespace meshlode::test
