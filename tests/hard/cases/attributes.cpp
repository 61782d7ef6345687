// SPDX-License-Identifier: GPL-3.0-or-later
// Normals, texture coordinates and colours that leave a simplifier no room, or have no sensible value.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "base/random.h"
#include "cases/shapes.h"
#include "hard_case.h"
#include "lab/samples/samples.h"

namespace meshlode::test::hard {

namespace {

constexpr std::uint32_t kCells = 12;

/// Every edge a crease, but for a share of the vertices.
Result<Sample> faceted(double cells) {
  return sample_of(lab::with_split_normals(make_lump(static_cast<std::uint32_t>(cells))));
}

/// A sheet that uses its texture, with coordinates by `uv`.
Sample textured(const std::function<Vec2f(const Vec3d&)>& uv) {
  scene::Primitive sheet = make_sheet(2 * kCells, 2 * kCells, false, false,
                                      [](double u, double v) { return Vec3d(u, 0.3 * u * u - 0.2 * v * v * v, -v); });
  for (const Vec3d& p : sheet.positions) sheet.uvs[0].push_back(uv(p));
  Sample sample = sample_of(std::move(sheet));
  sample.scene.materials[0].uv_sets_used = 1;
  return sample;
}

Result<Sample> uv_scale(double scale) {
  return textured([&](const Vec3d& p) { return Vec2f(Vec2d(p.x, -p.z) * scale); });
}

Result<Sample> uv_offset(double offset) {
  return textured([&](const Vec3d& p) { return Vec2f(Vec2d(p.x, -p.z) + Vec2d(offset, -offset)); });
}

/// Charts of `charts` columns, every other one mirrored, a seam between any two.
Result<Sample> uv_charts(double charts) {
  const auto columns = static_cast<std::uint32_t>(charts);
  const std::uint32_t across = std::max(1U, 48 / columns);
  scene::Primitive sheet;
  sheet.material = MaterialId(0U);
  for (std::uint32_t chart = 0; chart < columns; ++chart) {
    const double first = static_cast<double>(chart) / columns, last = static_cast<double>(chart + 1) / columns;
    const scene::Primitive part = make_sheet(across, 24, false, false, [&](double u, double v) {
      const double x = u == 1.0 ? last : first + u * (last - first);
      return Vec3d(x, 0.3 * x * x, -v);
    });
    const auto base = static_cast<std::uint32_t>(sheet.positions.size());
    for (const Vec3d& p : part.positions) {
      const double u = (p.x - first) / (last - first);
      sheet.positions.push_back(p);
      sheet.uvs[0].emplace_back(static_cast<float>(chart % 2 == 0 ? u : 1.0 - u), static_cast<float>(-p.z));
    }
    for (const std::uint32_t v : part.indices) sheet.indices.push_back(base + v);
  }
  Sample sample = sample_of(std::move(sheet));
  sample.scene.materials[0].uv_sets_used = 1;
  return sample;
}

/// Normals of any length: only their direction may count.
Result<Sample> normal_length(double length) {
  scene::Primitive lump = lab::with_smooth_normals(make_lump(kCells));
  for (Vec3f& n : lump.normals) n = Vec3f(Vec3d(n) * length);
  return sample_of(std::move(lump));
}

/// Colours far outside of 0 … 1.
Result<Sample> colour_range(double range) {
  scene::Primitive lump = make_lump(kCells);
  SplitMix64 random(9);
  for (std::size_t v = 0; v < lump.positions.size(); ++v) {
    lump.colors.emplace_back(static_cast<float>(range * random.unit()), static_cast<float>(-range * random.unit()),
                             0.5F, 1.0F);
  }
  return sample_of(std::move(lump));
}

}  // namespace

std::vector<HardCase> attribute_cases() {
  return {
      {.room = "attributes",
       .name = "faceted",
       .parameter = "cells along a face, every edge a crease",
       .sweep = {4, 12, 24},
       .is_whole = true,
       .is_quick = true,
       .make = faceted},
      {.room = "attributes",
       .name = "uv-scale",
       .parameter = "texture repeats along a side",
       .sweep = {1e0, 1e3, 1e6, 1e9, 1e18, 1e36},
       .is_quick = false,
       .make = uv_scale},
      {.room = "attributes",
       .name = "uv-offset",
       .parameter = "offset of texture coordinates",
       .sweep = {1e0, 1e3, 1e6, 1e9, 1e36},
       .is_quick = false,
       .make = uv_offset},
      {.room = "attributes",
       .name = "uv-charts",
       .parameter = "charts, every other one mirrored",
       .sweep = {1, 4, 16, 48},
       .is_whole = true,
       .is_quick = true,
       .make = uv_charts},
      {.room = "attributes",
       .name = "normal-length",
       .parameter = "length of the normals",
       .sweep = {1e0, 1e-6, 1e-19, 1e-30, 1e-44, 0.0},
       .is_quick = false,
       .make = normal_length},
      {.room = "attributes",
       .name = "colour-range",
       .parameter = "largest colour",
       .sweep = {1e0, 1e2, 1e20, 1e38},
       .is_quick = false,
       .make = colour_range},
  };
}

}  // namespace meshlode::test::hard
