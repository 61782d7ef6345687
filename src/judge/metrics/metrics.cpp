// SPDX-License-Identifier: GPL-3.0-or-later
// Two-sided deviation in the manner of Metro (Cignoni, Rocchini and Scopigno 1998), with stratified samples.
#include "judge/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

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
  [[nodiscard]] const Surface& surface() const { return surface_; }
  /// \pre i < sample_count()
  [[nodiscard]] std::uint32_t triangle_of(std::size_t i) const { return samples_.sample(i).triangle; }
  [[nodiscard]] std::span<const std::uint32_t> vertices() const { return vertices_; }

 private:
  const Surface& surface_;
  AreaSamples samples_;
  std::vector<std::uint32_t> vertices_;
};

/// Measured points in an order of their own.
class PointSequence {
 public:
  /// As they come: a cut's clusters are small already.
  explicit PointSequence(const MeasuredPoints& points) : points_(points) {}
  /// Along the leaves of a tree over their surface, so that near ones follow each other. A file's order leaps.
  PointSequence(const MeasuredPoints& points, const TriangleTree& tree) : points_(points) {
    const Surface& surface = points.surface();
    const auto samples = static_cast<std::uint32_t>(points.sample_count());
    std::vector<std::uint32_t> place(surface.triangles.size(), 0);
    std::vector<std::uint32_t> id_of_vertex(surface.positions.size(), kNone);
    for (std::uint32_t i = 0; i < points.vertices().size(); ++i) id_of_vertex[points.vertices()[i]] = samples + i;
    std::vector<std::uint32_t> vertices;
    vertices.reserve(points.vertices().size());
    for (std::uint32_t i = 0; i < tree.triangles_in_order().size(); ++i) {
      const std::uint32_t triangle = tree.triangles_in_order()[i];
      place[triangle] = i;
      for (const std::uint32_t v : surface.triangles[triangle]) {
        if (id_of_vertex[v] != kNone) vertices.push_back(id_of_vertex[v]);
        id_of_vertex[v] = kNone;
      }
    }
    std::vector<std::array<std::uint32_t, 2>> sorted(samples);
    for (std::uint32_t i = 0; i < samples; ++i) sorted[i] = {place[points.triangle_of(i)], i};
    std::sort(sorted.begin(), sorted.end());
    ids_.reserve(points.size());
    kept_.reserve(samples);
    for (const auto& [at, id] : sorted) {
      ids_.push_back(id);
      kept_.push_back(points[id]);
    }
    ids_.insert(ids_.end(), vertices.begin(), vertices.end());
  }
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] std::size_t id(std::size_t k) const { return ids_.empty() ? k : ids_[k]; }
  [[nodiscard]] Vec3d at(std::size_t k) const { return k < kept_.size() ? kept_[k] : points_[id(k)]; }

 private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;

  const MeasuredPoints& points_;
  std::vector<std::uint32_t> ids_;  ///< empty: 0, 1, 2 ...
  std::vector<Vec3d> kept_;         ///< the first of them: samples take longer to work out than to keep
};

/// Neither surface is empty.
OneWayDeviation measure_one_way(const MeasuredPoints& points, const TriangleTree& tree) {
  OneWayDeviation result;
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

OneWayDeviation nowhere_near() {
  OneWayDeviation result;
  result.max = result.rms = std::numeric_limits<double>::infinity();
  return result;
}

/// The search prunes by boxes, so that a distance may differ by where it began: in its last bits, and by what is lost
/// along an edge that is far longer than the distance, as shares of the distance and of the surfaces' extent.
constexpr double kSearchRounding = 1e-12, kEdgeRounding = 1e-14;

struct Farthest {
  double distance2 = -1.0;
  std::size_t point = 0;

  /// The farther one, of those that are as far the first.
  void take(const Farthest& other) {
    if (other.distance2 > distance2 || (other.distance2 == distance2 && other.point < point)) *this = other;
  }
};

struct Bounds {
  Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

Bounds bounds_of(const Surface& surface) {
  Bounds bounds;
  for (const Vec3d& p : surface.positions) {
    bounds.low = glm::min(bounds.low, p);
    bounds.high = glm::max(bounds.high, p);
  }
  return bounds;
}

/// Of the box around both.
double extent_of(const Bounds& a, const Bounds& b) {
  return glm::length(glm::max(a.high, b.high) - glm::min(a.low, b.low));
}

/// What one thread knows of a stretch of points that are near each other.
struct Walk {
  std::uint32_t hint = NearestPoint::kNone;
  Vec3d point{0.0};
  double reach = std::numeric_limits<double>::infinity();  ///< the surface is no farther than that from the point
};

/// The first of the points that is farthest from the surface of `to`; a distance of -1 where none is as far as
/// `largest2`, which is the largest known, of other points too, and grows.
Farthest find_farthest(const PointSequence& points, const TriangleTree& to, double extent,
                       std::atomic<double>& largest2) {
  std::vector<Farthest> partials((points.size() + kChunk - 1) / kChunk);
  parallel_for_each_index(partials.size(), 1, [&](std::size_t chunk) {
    Walk walk;
    for (std::size_t i = chunk * kChunk; i < std::min(points.size(), (chunk + 1) * kChunk); ++i) {
      // What other threads have found so far decides how long the search takes, not what comes of it: the point that is
      // farthest of all is never nearer than what is known but by the rounding of boxes and hints. What counts is its
      // distance without a hint.
      double known = largest2.load(std::memory_order_relaxed);
      const double near = std::max(0.0, std::sqrt(known) * (1.0 - kSearchRounding) - kEdgeRounding * extent);
      const Vec3d point = points.at(i);
      // Nor is it farther than the point before and the way from there.
      walk.reach += glm::length(point - walk.point);
      walk.point = point;
      if (walk.reach * (1.0 + kSearchRounding) < near) continue;
      const NearestPoint within = to.any_within(near * near, point, walk.hint);
      const bool is_within = within.triangle != NearestPoint::kNone;
      const NearestPoint nearest = is_within ? within : to.nearest(point);
      walk.hint = nearest.triangle;
      walk.reach = std::sqrt(nearest.distance2);
      if (is_within) continue;
      const double distance2 = nearest.distance2;
      partials[chunk].take({distance2, points.id(i)});
      while (distance2 > known && !largest2.compare_exchange_weak(known, distance2)) {
      }
    }
  });
  Farthest farthest;
  for (const Farthest& partial : partials) farthest.take(partial);
  return farthest;
}

}  // namespace

struct DeviationFrom::Parts {
  Parts(const Surface& a, const DeviationOptions& o)
      : surface(a),
        options(o),
        points(a, o),
        tree(a, TriangleTree::Positions::kShared),
        sequence(points, tree),
        bounds(bounds_of(a)) {}
  const Surface& surface;
  DeviationOptions options;
  MeasuredPoints points;
  TriangleTree tree;
  PointSequence sequence;
  Bounds bounds;
};

DeviationFrom::DeviationFrom(const Surface& a, const DeviationOptions& options)
    : parts_(std::make_unique<Parts>(a, options)) {}
DeviationFrom::~DeviationFrom() = default;
DeviationFrom::DeviationFrom(DeviationFrom&&) noexcept = default;

LargestDeviation DeviationFrom::find_largest(const Surface& b) const {
  const Surface& a = parts_->surface;
  LargestDeviation out;
  if (a.triangles.empty() || b.triangles.empty()) {
    if (a.triangles.empty() == b.triangles.empty()) return out;
    out.max = std::numeric_limits<double>::infinity();
    out.is_of_a = b.triangles.empty();
    return out;
  }
  std::atomic<double> largest2 = 0.0;
  const MeasuredPoints& points_a = parts_->points;
  const double extent = extent_of(parts_->bounds, bounds_of(b));
  const Farthest of_a =
      find_farthest(parts_->sequence, TriangleTree(b, TriangleTree::Positions::kShared), extent, largest2);
  const MeasuredPoints points_b(b, parts_->options);
  const Farthest of_b = find_farthest(PointSequence(points_b), parts_->tree, extent, largest2);
  out.is_of_a = of_a.distance2 >= of_b.distance2;
  const Farthest& farthest = out.is_of_a ? of_a : of_b;
  out.max = std::sqrt(std::max(0.0, farthest.distance2));
  out.worst = out.is_of_a ? points_a[farthest.point] : points_b[farthest.point];
  out.points = points_a.size() + points_b.size();
  return out;
}

DeviationReport DeviationFrom::measure(const Surface& b) const {
  DeviationReport report;
  const bool has_a = !parts_->surface.triangles.empty(), has_b = !b.triangles.empty();
  if (has_a && has_b) {
    report.a_to_b = measure_one_way(parts_->points, TriangleTree(b));
    report.b_to_a = measure_one_way(MeasuredPoints(b, parts_->options), parts_->tree);
  } else if (has_a) {
    report.a_to_b = nowhere_near();
  } else if (has_b) {
    report.b_to_a = nowhere_near();
  }
  return report;
}

}  // namespace meshlode::judge
