// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation in the manner of Metro (Cignoni, Rocchini and Scopigno 1998), with stratified samples.
#include "judge/metrics/metrics.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kChunk = 1024;  // queries that share a hint and a partial sum, whatever the thread count

/// The points of a surface that are measured: its samples, then all vertices that it uses.
class MeasuredPoints {
 public:
  MeasuredPoints(const Surface& surface, const DeviationOptions& options)
      : surface_(surface), samples_(surface, options.samples, options.seed), vertices_(used_vertices(surface)) {}
  [[nodiscard]] std::size_t sample_count() const { return static_cast<std::size_t>(samples_.count()); }
  [[nodiscard]] std::size_t size() const { return sample_count() + vertices_.size(); }
  [[nodiscard]] Vec3d operator[](std::size_t i) const {
    return i < sample_count() ? samples_.position(samples_.sample(i))
                              : surface_.positions[vertices_[i - sample_count()]];
  }

 private:
  const Surface& surface_;
  AreaSamples samples_;
  std::vector<std::uint32_t> vertices_;
};

OneWayDeviation measure_one_way(const Surface& from, const Surface& to, const TriangleTree& tree,
                                const DeviationOptions& options) {
  OneWayDeviation result;
  if (from.triangles.empty()) return result;
  if (to.triangles.empty()) {
    result.max = result.rms = std::numeric_limits<double>::infinity();
    return result;
  }
  const MeasuredPoints points(from, options);
  struct Partial {
    double max2 = -1.0;
    Vec3d worst{0.0};
    double sum2 = 0.0;
  };
  std::vector<Partial> partials((points.size() + kChunk - 1) / kChunk);
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    Partial& partial = partials[chunk];
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
      const Vec3d p = points[i];
      const NearestPoint nearest = tree.nearest(p, hint);
      hint = nearest.triangle;
      if (i < points.sample_count()) partial.sum2 += nearest.distance2;
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
  const auto samples = static_cast<double>(points.sample_count());
  result.rms = samples > 0.0 ? std::sqrt(total.sum2 / samples) : 0.0;
  result.worst = total.worst;
  result.points = points.size();
  return result;
}

/// The search prunes by boxes, so that a distance may differ by where it began: in its last bits, and by what is lost
/// along an edge that is far longer than the distance, as shares of the distance and of the surfaces' extent.
constexpr double kSearchRounding = 1e-12, kEdgeRounding = 1e-14;

struct Farthest {
  double distance2 = -1.0;
  std::size_t point = 0;
};

/// Of the box around both.
double extent_of(const Surface& a, const Surface& b) {
  Vec3d low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Surface* surface : {&a, &b}) {
    for (const Vec3d& p : surface->positions) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  }
  return glm::length(high - low);
}

/// The first of the points that is farthest from the surface of `to`; a distance of -1 where none is as far as
/// `largest2`, which is the largest known, of other points too, and grows.
Farthest find_farthest(const MeasuredPoints& points, const TriangleTree& to, double extent,
                       std::atomic<double>& largest2) {
  std::vector<Farthest> partials((points.size() + kChunk - 1) / kChunk);
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    std::uint32_t hint = 0xFFFFFFFFu;
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
      // What other threads have found so far decides how long the search takes, not what comes of it: the point that is
      // farthest of all is never nearer than what is known but by the rounding of boxes and hints. What counts is its
      // distance without a hint.
      double known = largest2.load(std::memory_order_relaxed);
      const double near = std::max(0.0, std::sqrt(known) * (1.0 - kSearchRounding) - kEdgeRounding * extent);
      const double enough = near * near;
      const Vec3d point = points[i];
      const NearestPoint nearest = to.nearest_unless_below(enough, point, hint);
      hint = nearest.triangle;
      if (nearest.distance2 < enough) continue;
      const double distance2 = to.nearest(point).distance2;
      if (distance2 > partials[chunk].distance2) partials[chunk] = {distance2, i};
      while (distance2 > known && !largest2.compare_exchange_weak(known, distance2)) {
      }
    }
  });
  Farthest farthest;
  for (const Farthest& partial : partials) {
    if (partial.distance2 > farthest.distance2) farthest = partial;
  }
  return farthest;
}

}  // namespace

LargestDeviation find_largest_deviation(const Surface& a, const Surface& b, const DeviationOptions& options) {
  LargestDeviation out;
  if (a.triangles.empty() || b.triangles.empty()) {
    if (a.triangles.empty() == b.triangles.empty()) return out;
    out.max = std::numeric_limits<double>::infinity();
    out.is_of_a = b.triangles.empty();
    return out;
  }
  std::atomic<double> largest2 = 0.0;
  const MeasuredPoints points_a(a, options), points_b(b, options);
  const double extent = extent_of(a, b);
  const Farthest of_a = find_farthest(points_a, TriangleTree(b), extent, largest2);
  const Farthest of_b = find_farthest(points_b, TriangleTree(a), extent, largest2);
  out.is_of_a = of_a.distance2 >= of_b.distance2;
  const Farthest& farthest = out.is_of_a ? of_a : of_b;
  out.max = std::sqrt(std::max(0.0, farthest.distance2));
  out.worst = out.is_of_a ? points_a[farthest.point] : points_b[farthest.point];
  out.points = points_a.size() + points_b.size();
  return out;
}

DeviationReport measure_deviation(const Surface& a, const Surface& b, const DeviationOptions& options) {
  const TriangleTree tree_a(a), tree_b(b);
  return {measure_one_way(a, b, tree_b, options), measure_one_way(b, a, tree_a, options)};
}

}  // namespace meshlode::judge
