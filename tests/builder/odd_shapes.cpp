// SPDX-License-Identifier: GPL-3.0-or-later
#include "odd_shapes.h"

#include <utility>

#include "base/random.h"
#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::test {

scene::Primitive make_fan(std::uint32_t valence) {
  scene::Primitive fan;
  fan.positions.emplace_back(0.0, 0.25, 0.0);
  for (std::uint32_t i = 0; i < valence; ++i) {
    const double turns = static_cast<double>(i) / valence;
    fan.positions.emplace_back(lab::cos_turns(turns), 0.0, -lab::sin_turns(turns));
    fan.indices.insert(fan.indices.end(), {0U, i + 1, (i + 1) % valence + 1});
  }
  fan.material = MaterialId(0U);
  return fan;
}

scene::Primitive make_triangle() {
  scene::Primitive triangle;
  triangle.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
  triangle.indices = {0, 1, 2};
  triangle.material = MaterialId(0U);
  return triangle;
}

scene::Primitive make_identical(std::uint32_t count) {
  scene::Primitive shape = make_triangle();
  for (std::uint32_t i = 1; i < count; ++i)
    shape.indices.insert(shape.indices.end(), {i % 3, (i + 1) % 3, (i + 2) % 3});
  return shape;
}

scene::Scene make_striped_plane(std::uint32_t n, std::uint32_t materials) {
  const scene::Primitive plane = lab::make_plane(n);
  scene::Scene scene;
  scene::SourceMesh& mesh = scene.meshes.emplace_back();
  mesh.name = "stripes";
  const std::size_t triangles = plane.indices.size() / 3;
  for (std::uint32_t m = 0; m < materials; ++m) {
    scene::Primitive& stripe = mesh.primitives.emplace_back(plane);
    stripe.indices.clear();
    for (std::size_t t = m * triangles / materials; t < (m + 1) * triangles / materials; ++t) {
      for (std::size_t k = 0; k < 3; ++k) stripe.indices.push_back(plane.indices[3 * t + k]);
    }
    stripe.material = MaterialId(m);
    scene.materials.emplace_back().source_index = m;
  }
  scene::SceneInstance& instance = scene.instances.emplace_back();
  instance.mesh = MeshId(0U);
  return scene;
}

scene::Primitive make_coincident_spheres(std::uint32_t n, std::uint32_t sheets) {
  const scene::Primitive sphere = lab::make_sphere(n);
  scene::Primitive shape = sphere;
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

scene::Primitive make_line_of_triangles(std::uint32_t count) {
  SplitMix64 random(17);
  scene::Primitive shape;
  for (std::uint32_t i = 0; i < 3 * count; ++i) {
    const double t = random.unit();
    shape.positions.emplace_back(t, 2.0 * t, -t);  // exactly collinear: powers of two times t
    shape.indices.push_back(i);
  }
  shape.material = MaterialId(0U);
  return shape;
}

scene::Primitive make_fine_rings_beside_a_patch(std::uint64_t seed) {
  SplitMix64 random(seed);
  scene::Primitive shape = lab::make_plane(12);
  shape.material = MaterialId(0U);
  for (Vec3d& p : shape.positions) p = p * 15.0 + Vec3d(0.0, 0.2 * random.unit(), 0.0);
  constexpr std::uint32_t kAround = 24, kAcross = 9;
  for (std::uint32_t ring = 0; ring < 6; ++ring) {
    const double radius = 0.03 + 0.01 * ring, thickness = 0.0002 + 0.0001 * ring;
    const auto first = static_cast<std::uint32_t>(shape.positions.size());
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const Vec3d out(lab::cos_turns(static_cast<double>(i) / kAround), 0.0,
                      lab::sin_turns(static_cast<double>(i) / kAround));
      for (std::uint32_t j = 0; j < kAcross; ++j) {
        const double beside = radius + thickness * lab::cos_turns(static_cast<double>(j) / kAcross);
        shape.positions.push_back(Vec3d(2.0 * ring, 3.0, 5.0) + out * beside +
                                  Vec3d(0.0, thickness * lab::sin_turns(static_cast<double>(j) / kAcross), 0.0));
      }
    }
    for (std::uint32_t i = 0; i < kAround; ++i) {
      for (std::uint32_t j = 0; j < kAcross; ++j) {
        const std::uint32_t a = first + i * kAcross + j, b = first + i * kAcross + (j + 1) % kAcross;
        const std::uint32_t c = first + (i + 1) % kAround * kAcross + j;
        const std::uint32_t d = first + (i + 1) % kAround * kAcross + (j + 1) % kAcross;
        for (const std::uint32_t v : {a, b, c, b, d, c}) shape.indices.push_back(v);
      }
    }
  }
  const std::size_t count = shape.indices.size() / 3;
  const auto corner = [&](std::size_t t, std::size_t k) { return shape.indices[3 * t + k]; };
  for (std::size_t t = 0; t < count; t += 7) {
    for (const std::uint32_t v : {corner(t, 1), corner(t, 0), corner(t, 2)}) shape.indices.push_back(v);
  }
  for (std::size_t t = 0; t < count; t += 11) {
    for (const std::uint32_t v : {corner(t, 0), corner(t, 1), corner(t, 1)}) shape.indices.push_back(v);
  }
  return shape;
}

scene::Primitive make_ball_with_hairs() {
  scene::Primitive shape = lab::make_sphere(16);
  shape.normals.clear();
  shape.material = MaterialId(0U);
  const auto at = [&](double x, double y, double z) {
    shape.positions.emplace_back(x, y, z);
    return static_cast<std::uint32_t>(shape.positions.size() - 1);
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t v : {a, b, c}) shape.indices.push_back(v);
  };
  add(at(0, 1, 0), at(0, 1, 0), at(3, 0, 0));
  add(at(0, 0.5, 0), at(0, 2, 0), at(0, 3, 0));
  const std::uint32_t p = at(0, 0, 2), q = at(0, 0, 2.5), r = at(0, 0, 3), s = at(0, 0, 2.25);
  add(p, r, q);
  add(p, q, s);
  return shape;
}

scene::Primitive make_cube_with_t_junctions() {
  scene::Primitive shape = lab::make_cube(1);
  shape.normals.clear();
  shape.material = MaterialId(0U);
  // Every edge of the first triangle gets two more vertices, which its neighbours do not have.
  const std::uint32_t a = shape.indices[0], b = shape.indices[1], c = shape.indices[2];
  shape.indices.erase(shape.indices.begin(), shape.indices.begin() + 3);
  const auto add = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    for (const std::uint32_t v : {i, j, k}) shape.indices.push_back(v);
  };
  const auto between = [&](std::uint32_t i, std::uint32_t j, double t) {
    shape.positions.push_back(shape.positions[i] * (1.0 - t) + shape.positions[j] * t);
    return static_cast<std::uint32_t>(shape.positions.size() - 1);
  };
  shape.positions.push_back((shape.positions[a] * 2.0 + shape.positions[b] + shape.positions[c]) * 0.25);
  const auto inside = static_cast<std::uint32_t>(shape.positions.size() - 1);
  for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const std::uint32_t first = between(i, j, 0.25), second = between(i, j, 0.5);
    add(i, first, inside);
    add(first, second, inside);
    add(second, j, inside);
    add(i, second, first);
    add(i, j, second);
  }
  return shape;
}

scene::Primitive make_cards(std::uint32_t count, std::uint64_t seed) {
  SplitMix64 random(seed);
  const auto vector = [&](double size) {
    Vec3d v;
    for (int k = 0; k < 3; ++k) v[k] = size * (2.0 * random.scaled_below(1U << 20U) / (1U << 20U) - 1.0);
    return v;
  };
  scene::Primitive shape;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d center = vector(10.0), u = vector(0.2), v = vector(0.2);
    const std::uint32_t first = 4 * i;
    for (const Vec3d& corner : {-u - v, u - v, u + v, v - u}) shape.positions.push_back(center + corner);
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) shape.indices.push_back(first + k);
  }
  shape.material = MaterialId(0U);
  return shape;
}

scene::Primitive make_lattice_chaos(std::uint32_t count, std::uint32_t side, std::uint64_t seed) {
  SplitMix64 random(seed);
  scene::Primitive shape;
  for (std::uint32_t z = 0; z < side; ++z) {
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) shape.positions.emplace_back(x, y, z);
    }
  }
  const std::uint32_t points = side * side * side;
  for (std::uint32_t i = 0; i < 3 * count; ++i) shape.indices.push_back(random.scaled_below(points));
  shape.material = MaterialId(0U);
  return shape;
}

}  // namespace meshlode::test
