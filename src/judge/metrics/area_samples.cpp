// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/area_samples.h"

#include <algorithm>

#include "base/random.h"

namespace meshlode::judge {
namespace {

// Uniform in [0, 1): a hash of seed, sample and draw (splitmix64's mixer, twice).
double uniform(std::uint64_t seed, std::uint64_t sample, std::uint64_t draw) {
  const std::uint64_t z =
      mix64(mix64(seed * kGoldenGamma + sample * 0xD1B54A32D192ED03ULL + (draw + 1) * 0x8CB92BA72F3D8DD7ULL));
  return static_cast<double>(z >> 11) * 0x1p-53;
}

}  // namespace

AreaSamples::AreaSamples(const Surface& surface, std::uint64_t count, std::uint64_t seed)
    : surface_(surface), count_(count), seed_(seed), cumulative_(surface.triangles.size()) {
  double sum = 0.0;
  for (std::size_t i = 0; i < cumulative_.size(); ++i) {
    const auto& t = surface.triangles[i];
    const Vec3d& a = surface.positions[t[0]];
    sum += 0.5 * glm::length(glm::cross(surface.positions[t[1]] - a, surface.positions[t[2]] - a));
    cumulative_[i] = sum;
  }
}

SurfacePoint AreaSamples::sample(std::uint64_t i) const {
  const double at = (static_cast<double>(i) + uniform(seed_, i, 0)) / static_cast<double>(count_);
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), at * area());
  const auto index =
      std::min<std::size_t>(static_cast<std::size_t>(found - cumulative_.begin()), cumulative_.size() - 1);
  double u = uniform(seed_, i, 1), v = uniform(seed_, i, 2);
  if (u + v > 1.0) {  // fold the parallelogram onto the triangle
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {static_cast<std::uint32_t>(index), u, v};
}

Vec3d AreaSamples::position(const SurfacePoint& point) const {
  const auto& t = surface_.triangles[point.triangle];
  const Vec3d& a = surface_.positions[t[0]];
  return a + (surface_.positions[t[1]] - a) * point.u + (surface_.positions[t[2]] - a) * point.v;
}

std::vector<std::uint32_t> used_vertices(const Surface& surface) {
  return used_vertices(surface, surface.triangles.size());
}

std::vector<std::uint32_t> used_vertices(const Surface& surface, std::size_t triangle_count) {
  std::vector<std::uint8_t> is_used(surface.positions.size(), 0);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    for (const std::uint32_t v : surface.triangles[t]) is_used[v] = 1;
  }
  std::vector<std::uint32_t> used;
  used.reserve(static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), 1)));
  for (std::size_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v] != 0) used.push_back(static_cast<std::uint32_t>(v));
  }
  return used;
}

}  // namespace meshlode::judge
