// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation in the manner of Metro (Cignoni, Rocchini and Scopigno 1998), with stratified samples.
#include "judge/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kChunk = 1024;  // queries that share a hint and a partial sum, whatever the thread count

OneWayDeviation measure_one_way(const Surface& from, const Surface& to, const TriangleTree& tree,
                                const DeviationOptions& options) {
  OneWayDeviation result;
  if (from.triangles.empty()) return result;
  if (to.triangles.empty()) {
    result.max = result.rms = std::numeric_limits<double>::infinity();
    return result;
  }
  const AreaSamples samples(from, options.samples, options.seed);
  const std::uint64_t sample_count = samples.count();
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
      const Vec3d p = is_sample ? samples.position(samples.sample(i)) : from.positions[vertices[i - sample_count]];
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

}  // namespace meshlode::judge
