// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/product_distance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/box.h"
#include "base/parallel.h"
#include "judge/metrics/area_samples.h"
#include "judge/metrics/product_points.h"
#include "judge/metrics/product_tree.h"

namespace meshlode::judge {
namespace {

constexpr std::size_t kFirstStride = 61;  // of the points that are looked at first
constexpr std::size_t kChunk = 512;       // queries that share a hint, whatever the thread count
// By what a distance may differ with where the search began, for boxes prune, and roundings of needles differ: as
// shares of the distance and of the surfaces' extent.
constexpr double kSearchRounding = 1e-9, kSearchFloor = 1e-12;

template <std::size_t N>
double distance_between(const ProductPoint<N>& a, const ProductPoint<N>& b) {
  const product::Row<N> d = product::minus<N>(a.x, b.x);
  return std::sqrt(product::dot<N>(d, d));
}

Box3d bounds_of(const Surface& surface) {
  Box3d bounds;
  for (const Vec3d& p : surface.positions) bounds.add(p);
  return bounds;
}

/// A surface as points and a tree.
template <std::size_t N>
struct Measured {
  std::vector<ProductPoint<N>> points;  ///< near ones one after another
  std::vector<std::uint32_t> id;        ///< of a point: samples first, then vertices, as they come
  ProductTree<N> tree;
};

template <std::size_t N>
Measured<N> make_measured(const ShadedSurface& s, const ProductScales& scales, const DeviationOptions& options) {
  const product::Coordinates at = product::coordinates_of(scales);
  std::vector<ProductPoint<N>> vertices = product::vertices_of<N>(s, scales, at);
  Measured<N> out{{}, {}, ProductTree<N>(vertices, s.surface.triangles, at.layout)};
  const AreaSamples samples(s.surface, options.samples, options.seed);
  const auto sample_count = static_cast<std::uint32_t>(samples.count());
  std::vector<std::uint32_t> place(s.surface.triangles.size(), 0);
  const std::vector<std::uint32_t>& order = out.tree.triangles_in_order();
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  std::vector<std::array<std::uint32_t, 2>> sorted(sample_count);
  std::vector<SurfacePoint> sampled(sample_count);
  for (std::uint32_t i = 0; i < sample_count; ++i) {
    sampled[i] = samples.sample(i);
    sorted[i] = {place[sampled[i].triangle], i};
  }
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [unused, i] : sorted) {
    const SurfacePoint& sample = sampled[i];
    out.points.push_back(product::point_at<N>(vertices, s.surface.triangles[sample.triangle], sample, at.layout));
    out.id.push_back(i);
  }
  std::vector<std::uint32_t> id_of_vertex(vertices.size(), 0xFFFFFFFFu);
  std::uint32_t next = sample_count;
  const std::size_t drawn = s.surface.triangles.size() - s.undrawn;
  for (const std::uint32_t v : used_vertices(s.surface, drawn)) id_of_vertex[v] = next++;
  for (const std::uint32_t triangle : order) {
    for (const std::uint32_t v : s.surface.triangles[triangle]) {
      if (id_of_vertex[v] == 0xFFFFFFFFu) continue;
      out.points.push_back(vertices[v]);
      out.id.push_back(id_of_vertex[v]);
      id_of_vertex[v] = 0xFFFFFFFFu;
    }
  }
  return out;
}

struct Farthest {
  double distance = -1.0;
  std::uint32_t id = 0;
  Vec3d position{0.0};

  /// The farther one, of those that are as far the first.
  void take(const Farthest& other) {
    if (other.distance > distance || (other.distance == distance && other.id < id)) *this = other;
  }
};

/// The first of the points that is farthest, weighted, from the triangles of `to`; `largest` is what is known of other
/// points, and grows.
template <std::size_t N>
Farthest find_farthest(const Measured<N>& from, const ProductTree<N>& to, double extent, const DistanceWeight& weight,
                       std::atomic<double>& largest) {
  const auto raise = [&](double known, double distance) {
    while (distance > known && !largest.compare_exchange_weak(known, distance)) {
    }
  };
  // A few points from everywhere first: what they find spares most others the end of their search.
  parallel_for_each_chunk(
      chunk_count(from.points.size(), kFirstStride), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const ProductPoint<N>& point = from.points[i * kFirstStride];
          const double counts = weight ? weight(point.position()) : 1.0;
          raise(largest.load(std::memory_order_relaxed), counts * std::sqrt(to.nearest(point).distance2));
        }
      });
  std::vector<Farthest> partials(chunk_count(from.points.size(), kChunk));
  parallel_for_each_chunk(from.points.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t hint = kNoId;
    double reach = std::numeric_limits<double>::infinity();  // the surface is no farther from the point before
    for (std::size_t i = begin; i < end; ++i) {
      // What is known so far decides how long the search takes, not what comes of it: the farthest point is never
      // nearer than that but by rounding, and what counts is its distance without a hint.
      const ProductPoint<N>& point = from.points[i];
      const double counts = weight ? weight(point.position()) : 1.0;
      const double known = largest.load(std::memory_order_relaxed);
      const double near = std::max(0.0, known / counts * (1.0 - kSearchRounding) - kSearchFloor * extent);
      reach = i > begin && point.known == from.points[i - 1].known
                  ? reach + distance_between<N>(point, from.points[i - 1])
                  : std::numeric_limits<double>::infinity();
      if (reach * (1.0 + kSearchRounding) < near) continue;
      const auto within = to.any_within(near * near, point, hint);
      if (within.triangle != kNoId) {
        hint = within.triangle;
        reach = std::sqrt(within.distance2);
        continue;
      }
      const auto nearest = to.nearest(point);
      hint = nearest.triangle;
      reach = std::sqrt(nearest.distance2);
      const double distance = counts * reach;
      partials[chunk].take({distance, from.id[i], point.position()});
      raise(known, distance);
    }
  });
  Farthest farthest;
  for (const Farthest& partial : partials) farthest.take(partial);
  return farthest;
}

template <std::size_t N>
LargestDeviation find_largest_of(const Measured<N>& a, const Box3d& bounds_a, const ShadedSurface& surface_b,
                                 const ProductScales& scales, const DeviationOptions& options,
                                 const DistanceWeight& weight) {
  LargestDeviation out;
  if (a.tree.empty() || surface_b.surface.triangles.empty()) {
    if (a.tree.empty() == surface_b.surface.triangles.empty()) return out;
    out.max = std::numeric_limits<double>::infinity();
    out.is_of_a = !a.tree.empty();
    return out;
  }
  const Measured<N> b = make_measured<N>(surface_b, scales, options);
  Box3d bounds = bounds_of(surface_b.surface);
  bounds.add(bounds_a);
  const double extent = glm::length(bounds.size());
  std::atomic<double> largest = 0.0;
  const Farthest of_a = find_farthest<N>(a, b.tree, extent, weight, largest);
  const Farthest of_b = find_farthest<N>(b, a.tree, extent, weight, largest);
  out.is_of_a = of_a.distance >= of_b.distance;
  const Farthest& farthest = out.is_of_a ? of_a : of_b;
  out.max = std::max(0.0, farthest.distance);
  out.worst = farthest.position;
  out.points = a.points.size() + b.points.size();
  return out;
}

}  // namespace

struct ProductDistanceFrom::Parts {
  ProductScales scales;
  DeviationOptions options;
  Box3d bounds;
  std::optional<Measured<product::kFew>> few;  ///< one of them
  std::optional<Measured<product::kMany>> many;
};

ProductDistanceFrom::ProductDistanceFrom(const ShadedSurface& a, const ProductScales& scales,
                                         const DeviationOptions& options)
    : parts_(std::make_unique<Parts>()) {
  parts_->scales = scales;
  parts_->options = options;
  parts_->bounds = bounds_of(a.surface);
  if (product::coordinates_of(scales).layout.size() <= product::kFew) {
    parts_->few.emplace(make_measured<product::kFew>(a, scales, options));
  } else {
    parts_->many.emplace(make_measured<product::kMany>(a, scales, options));
  }
}
ProductDistanceFrom::~ProductDistanceFrom() = default;
ProductDistanceFrom::ProductDistanceFrom(ProductDistanceFrom&&) noexcept = default;

LargestDeviation ProductDistanceFrom::find_largest(const ShadedSurface& b, const DistanceWeight& weight) const {
  const Parts& p = *parts_;
  return p.few ? find_largest_of<product::kFew>(*p.few, p.bounds, b, p.scales, p.options, weight)
               : find_largest_of<product::kMany>(*p.many, p.bounds, b, p.scales, p.options, weight);
}

struct ProductSurface::Parts {
  template <std::size_t N>
  struct Points {
    std::vector<ProductPoint<N>> vertices;
    ProductTree<N> tree;
  };
  ProductLayout layout;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::optional<Points<product::kFew>> few;  ///< one of them
  std::optional<Points<product::kMany>> many;

  template <std::size_t N>
  [[nodiscard]] Points<N> points_of(const ShadedSurface& s, const ProductScales& scales) const {
    std::vector<ProductPoint<N>> vertices = product::vertices_of<N>(s, scales, product::coordinates_of(scales));
    ProductTree<N> tree(vertices, triangles, layout);
    return {std::move(vertices), std::move(tree)};
  }
};

ProductSurface::ProductSurface(const ShadedSurface& s, const ProductScales& scales)
    : parts_(std::make_unique<Parts>()) {
  parts_->layout = product::coordinates_of(scales).layout;
  parts_->triangles = s.surface.triangles;
  if (parts_->layout.size() <= product::kFew) {
    parts_->few.emplace(parts_->points_of<product::kFew>(s, scales));
  } else {
    parts_->many.emplace(parts_->points_of<product::kMany>(s, scales));
  }
}
ProductSurface::~ProductSurface() = default;
ProductSurface::ProductSurface(ProductSurface&&) noexcept = default;

double ProductSurface::distance_to(const ProductSurface& other, std::uint32_t triangle, double b, double c) const {
  const Parts& own = *parts_;
  const SurfacePoint at{triangle, b, c};
  const auto distance = [&](const auto& from, const auto& to) {
    return std::sqrt(
        to.tree.nearest(product::point_at(from.vertices, own.triangles[triangle], at, own.layout)).distance2);
  };
  return own.few ? distance(*own.few, *other.parts_->few) : distance(*own.many, *other.parts_->many);
}

}  // namespace meshlode::judge
