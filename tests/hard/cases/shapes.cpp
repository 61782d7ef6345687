// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/shapes.h"

#include <utility>

#include "lab/samples/noise.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

scene::Primitive make_sheet(std::uint32_t columns, std::uint32_t rows, bool closes_u, bool closes_v,
                            const std::function<Vec3d(double u, double v)>& place) {
  scene::Primitive sheet;
  sheet.material = MaterialId(0U);
  const std::uint32_t across = closes_u ? columns : columns + 1, along = closes_v ? rows : rows + 1;
  for (std::uint32_t j = 0; j < along; ++j) {
    for (std::uint32_t i = 0; i < across; ++i) {
      sheet.positions.push_back(place(static_cast<double>(i) / columns, static_cast<double>(j) / rows));
    }
  }
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t a = j * across + i, b = j * across + (i + 1) % across;
      const std::uint32_t c = (j + 1) % along * across + (i + 1) % across, d = (j + 1) % along * across + i;
      for (const std::uint32_t v : {a, b, c, a, c, d}) sheet.indices.push_back(v);
    }
  }
  return sheet;
}

scene::Primitive make_bumpy_plane(std::uint32_t n, double height) {
  return make_sheet(n, n, false, false, [&](double u, double v) {
    const auto i = static_cast<std::uint32_t>(u * n + 0.5), j = static_cast<std::uint32_t>(v * n + 0.5);
    return Vec3d(u, (i + j) % 2 == 0 ? height : 0.0, -v);
  });
}

scene::Primitive make_lump(std::uint32_t n, double height) {
  return mapped(lab::make_sphere(n), [&](const Vec3d& p) {
    return p * (1.0 + height * lab::fractal_noise(3.0 * p + Vec3d(0.3, 0.7, 0.1), 3, 5));
  });
}

scene::Primitive make_klein(std::uint32_t n) {
  // The figure-eight immersion: an eight that turns half around while it goes round. Going round once swaps its lobes,
  // so that the last column joins the first with the row mirrored.
  scene::Primitive bottle;
  bottle.material = MaterialId(0U);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
      const double c = lab::cos_turns(0.5 * u), s = lab::sin_turns(0.5 * u);
      const double along = lab::sin_turns(v), twice = lab::sin_turns(2.0 * v);
      const double radius = 2.0 + c * along - s * twice;
      bottle.positions.emplace_back(radius * lab::cos_turns(u), radius * lab::sin_turns(u), s * along + c * twice);
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return i < n ? i * n + j % n : (n - j % n) % n;  // (1, v) is (0, 1 - v): sin(-v) and sin(-2v) there
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const std::uint32_t v : {a, b, c, a, c, d}) bottle.indices.push_back(v);
    }
  }
  return bottle;
}

scene::Primitive mapped(scene::Primitive shape, const std::function<Vec3d(const Vec3d&)>& map) {
  for (Vec3d& p : shape.positions) p = map(p);
  return shape;
}

scene::Primitive joined(const scene::Primitive& a, const scene::Primitive& b) {
  scene::Primitive both;
  both.material = a.material.is_valid() ? a.material : MaterialId(0U);
  both.positions = a.positions;
  both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
  both.indices = a.indices;
  for (const std::uint32_t v : b.indices) both.indices.push_back(static_cast<std::uint32_t>(a.positions.size()) + v);
  return both;
}

scene::Primitive turned(scene::Primitive shape) {
  for (std::size_t t = 0; t + 2 < shape.indices.size(); t += 3) std::swap(shape.indices[t + 1], shape.indices[t + 2]);
  for (Vec3f& n : shape.normals) n = -n;
  return shape;
}

}  // namespace meshlode::test::hard
