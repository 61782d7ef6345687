// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation in the manner of Metro (Cignoni, Rocchini and Scopigno 1998), with stratified samples: the i-th
// of n lies in the i-th n-th of the area, so that no region is missed by chance.
#include "metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "metrics/triangle_tree.h"

namespace meshlode {
namespace {

constexpr std::size_t kChunk = 1024;  // queries that share a hint and a partial sum, whatever the thread count

// Uniform in [0, 1): a hash of seed, sample and draw (splitmix64's mixer).
double uniform(std::uint64_t seed, std::uint64_t sample, std::uint64_t draw) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15ULL + sample * 0xD1B54A32D192ED03ULL + (draw + 1) * 0x8CB92BA72F3D8DD7ULL;
  for (int round = 0; round < 2; ++round) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1p-53;
}

// Area of the triangles up to and including each one.
std::vector<double> cumulative_areas(const Surface& s) {
  std::vector<double> sums(s.triangles.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const auto& t = s.triangles[i];
    const Vec3d& a = s.positions[t[0]];
    sum += 0.5 * glm::length(glm::cross(s.positions[t[1]] - a, s.positions[t[2]] - a));
    sums[i] = sum;
  }
  return sums;
}

Vec3d sample_point(const Surface& s, const std::vector<double>& areas, const DeviationOptions& options,
                   std::uint64_t i) {
  const double at = (static_cast<double>(i) + uniform(options.seed, i, 0)) / static_cast<double>(options.samples);
  const auto found = std::upper_bound(areas.begin(), areas.end(), at * areas.back());
  const std::size_t triangle = std::min<std::size_t>(static_cast<std::size_t>(found - areas.begin()), areas.size() - 1);
  const auto& t = s.triangles[triangle];
  double u = uniform(options.seed, i, 1), v = uniform(options.seed, i, 2);
  if (u + v > 1.0) {  // fold the parallelogram onto the triangle
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vec3d& a = s.positions[t[0]];
  return a + (s.positions[t[1]] - a) * u + (s.positions[t[2]] - a) * v;
}

std::vector<std::uint32_t> used_vertices(const Surface& s) {
  std::vector<std::uint8_t> is_used(s.positions.size(), 0);
  for (const auto& t : s.triangles) {
    for (const std::uint32_t v : t) is_used[v] = 1;
  }
  std::vector<std::uint32_t> used;
  for (std::size_t v = 0; v < is_used.size(); ++v) {
    if (is_used[v] != 0) used.push_back(static_cast<std::uint32_t>(v));
  }
  return used;
}

OneWayDeviation measure_one_way(const Surface& from, const Surface& to, const TriangleTree& tree,
                                const DeviationOptions& options) {
  OneWayDeviation result;
  if (from.triangles.empty()) return result;
  if (to.triangles.empty()) {
    result.max = result.rms = std::numeric_limits<double>::infinity();
    return result;
  }
  const std::vector<double> areas = cumulative_areas(from);
  const std::uint64_t sample_count = areas.back() > 0.0 ? options.samples : 0;
  const std::vector<std::uint32_t> vertices = used_vertices(from);
  const std::size_t point_count = static_cast<std::size_t>(sample_count) + vertices.size();
  struct Partial {
    double max2 = -1.0;
    Vec3d worst{0.0};
    double sum2 = 0.0;
  };
  std::vector<Partial> partials((point_count + kChunk - 1) / kChunk);
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    Partial& partial = partials[chunk];
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(point_count, (chunk + 1) * kChunk); ++i) {
      const bool is_sample = i < sample_count;
      const Vec3d p = is_sample ? sample_point(from, areas, options, i) : from.positions[vertices[i - sample_count]];
      const NearestPoint nearest = tree.nearest(p, hint);
      hint = nearest.triangle;
      if (is_sample) partial.sum2 += nearest.distance2;
      if (nearest.distance2 > partial.max2) {
        partial.max2 = nearest.distance2;
        partial.worst = p;
      }
    }
  });
  Partial total;
  for (const Partial& p : partials) {
    total.sum2 += p.sum2;
    if (p.max2 > total.max2) {
      total.max2 = p.max2;
      total.worst = p.worst;
    }
  }
  result.max = std::sqrt(std::max(0.0, total.max2));
  result.rms = sample_count > 0 ? std::sqrt(total.sum2 / static_cast<double>(sample_count)) : 0.0;
  result.worst = total.worst;
  result.points = point_count;
  return result;
}

}  // namespace

DeviationReport measure_deviation(const Surface& a, const Surface& b, const DeviationOptions& options) {
  const TriangleTree tree_a(a), tree_b(b);
  return {measure_one_way(a, b, tree_b, options), measure_one_way(b, a, tree_a, options)};
}

}  // namespace meshlode
