// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces to measure, and the judge's metrics as the oracle.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "builder/deviation/deviation.h"
#include "builder/deviation/point_distance.h"
#include "judge/metrics/metrics.h"
#include "lab/samples/samples.h"
#include "support/random.h"

namespace meshlode::test {

inline judge::Surface as_surface(const scene::Primitive& shape) {
  judge::Surface surface;
  surface.positions = shape.positions;
  for (std::size_t i = 0; i + 2 < shape.indices.size(); i += 3) {
    surface.triangles.push_back({shape.indices[i], shape.indices[i + 1], shape.indices[i + 2]});
  }
  return surface;
}

inline judge::Surface transformed(judge::Surface surface, double factor, const Vec3d& offset) {
  for (Vec3d& p : surface.positions) p = p * factor + offset;
  return surface;
}

inline builder::GroupSurface as_group(const judge::Surface& surface) {
  return {surface.positions, surface.triangles};
}

/// From a point to the nearest of all triangles.
inline double brute_force(const judge::Surface& surface, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& t : surface.triangles) {
    best = std::min(best, builder::point_triangle_distance2(
                              p, {surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]]}));
  }
  return std::sqrt(best);
}

/// The larger of the two maxima over dense samples and all vertices.
inline double dense_truth(const judge::Surface& a, const judge::Surface& b, std::uint64_t samples = 20000) {
  return judge::DeviationFrom(a, {.samples = samples}).measure(b).max();
}

inline judge::Surface random_soup(Random& random, std::uint32_t count, double size, double edge) {
  judge::Surface surface;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d at(random.signed_unit() * size, random.signed_unit() * size, random.signed_unit() * size);
    for (int k = 0; k < 3; ++k) {
      surface.positions.push_back(at + edge * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit()));
    }
    surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return surface;
}

}  // namespace meshlode::test
