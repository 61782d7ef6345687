// SPDX-License-Identifier: GPL-3.0-or-later
// Covering (deviation/cover.h) in the product space.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/parallel.h"
#include "builder/deviation/cover.h"
#include "builder/promise/partners.h"
#include "builder/promise/product_point.h"
#include "builder/promise/product_tree.h"

namespace meshlode::builder {

// What doubles may lose in one step, with u = 2^-53 and C the largest coordinate: each coordinate of a distance
// (product_distance2) is off by 12 roundings of numbers of 2C at most, and the weights by 2u of an edge: √14 · 28u C <
// 105u C. New corners of pieces, as in certify.cpp with √14 for √3: 1560u C. Sums and roots: rounded_up().
constexpr double kProductMargin = 0x1p-42;  // 2048u, of C

/// A surface, for Cover. It must outlive this.
template <std::size_t D>
class ProductTarget {
 public:
  using Point = ProductPoint<D>;
  using Place = std::uint32_t;
  struct Corners {
    const Point *a, *b, *c;
  };
  struct Plane {
    [[nodiscard]] double side(const Point&) const { return 0.0; }
  };

  explicit ProductTarget(const ProductSurface<D>& surface) : surface_(surface), tree_(surface) {}

  [[nodiscard]] Place nearest(const Point& p, Place hint) const {
    const auto hit = tree_.find(p, hint, 0.0);
    return hit.triangle != kNoId ? hit.triangle : hint != kNoId ? hint : 0;
  }
  [[nodiscard]] Corners corners_at(Place place) const {
    const auto& [a, b, c] = surface_.triangles[place];
    return {&surface_.points[a], &surface_.points[b], &surface_.points[c]};
  }
  [[nodiscard]] static double distance2(const Point& p, const Corners& corners) {
    return product_distance2<D>(p, *corners.a, *corners.b, *corners.c);
  }
  [[nodiscard]] double distance2_at(const Point& p, Place place) const { return distance2(p, corners_at(place)); }
  [[nodiscard]] static std::optional<Plane> bisector(Place, Place) { return std::nullopt; }
  [[nodiscard]] static Point middle(std::span<const Point> points) {
    Point out{};
    for (const Point& p : points) {
      for (std::size_t d = 0; d < D; ++d) out[d] += p[d];
    }
    for (double& value : out) value /= static_cast<double>(points.size());
    return out;
  }
  [[nodiscard]] static Point mix(const Point& a, const Point& b, double share) {
    Point out;
    for (std::size_t d = 0; d < D; ++d) out[d] = a[d] + (b[d] - a[d]) * share;
    return out;
  }
  [[nodiscard]] static double length2(const Point& a, const Point& b) {
    double sum = 0.0;
    for (std::size_t d = 0; d < D; ++d) sum += (b[d] - a[d]) * (b[d] - a[d]);
    return sum;
  }

 private:
  const ProductSurface<D>& surface_;
  ProductTree<D> tree_;
};

/// Pieces that cover all triangles of a surface, each within what is written beside it of a triangle of `by`. Those
/// within `enough` are good enough, whole triangles of their partners, if there are any: ids of `by`, or kNoId.
/// \pre neither is empty
template <std::size_t D>
std::vector<GivenPiece> cover_product_surface(const ProductSurface<D>& surface, const ProductSurface<D>& by,
                                              double enough, std::span<const std::uint32_t> partners) {
  constexpr std::size_t kChunk = 256;  // of what shares a hint, whatever the thread count
  // Pieces of a triangle: on the average, so many times what is left for each at most, and in any case; and Cover's
  // few. Where a texture is chaos every triangle is far from all others and near to none, and each search looks at
  // nearly all.
  constexpr std::size_t kPieces = 32, kMostOfMean = 8, kLeastPieces = 8, kMostPieces = 512, kFewPieces = 16;
  const ProductTarget<D> target(by);
  const std::size_t count = surface.triangles.size();
  std::vector<std::vector<GivenPiece>> given(chunk_count(count, kChunk));
  std::vector<std::uint8_t> is_covered(count, 0), is_looked_for(surface.points.size(), 0);
  if (!partners.empty()) {
    parallel_for_each_chunk(count, kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        if (partners[t] == kNoId) continue;
        double farthest2 = 0.0;
        for (const std::uint32_t v : surface.triangles[t]) {
          const double distance2 = target.distance2_at(surface.points[v], partners[t]);
          if (!(distance2 <= farthest2)) farthest2 = distance2;  // not a number either
        }
        if (!(std::sqrt(farthest2) <= enough)) continue;
        is_covered[t] = 1;
        given[chunk].push_back({static_cast<std::uint32_t>(t), partners[t], std::sqrt(farthest2)});
      }
    });
  }
  for (std::size_t t = 0; t < count; ++t) {
    if (is_covered[t] != 0) continue;
    for (const std::uint32_t v : surface.triangles[t]) is_looked_for[v] = 1;
  }
  std::vector<std::uint32_t> place(surface.points.size());
  std::vector<double> distance(surface.points.size());
  std::vector<double> of_chunk(chunk_count(surface.points.size(), kChunk), 0.0);
  parallel_for_each_chunk(surface.points.size(), kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    std::uint32_t hint = kNoId;
    for (std::size_t v = begin; v < end; ++v) {
      if (is_looked_for[v] == 0) continue;
      hint = place[v] = target.nearest(surface.points[v], hint);
      distance[v] = std::sqrt(target.distance2_at(surface.points[v], hint));
      of_chunk[chunk] = std::max(of_chunk[chunk], distance[v]);
    }
  });
  double largest = 0.0;
  for (const double d : of_chunk) largest = std::max(largest, d);
  parallel_for_each_chunk(count, kChunk, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Cover<ProductTarget<D>> way(target, largest, enough);
    std::size_t left = kPieces * (end - begin);
    for (std::size_t t = begin; t < end; ++t) {
      if (is_covered[t] != 0) continue;
      typename Cover<ProductTarget<D>>::Piece piece;
      for (const std::uint32_t v : surface.triangles[t]) piece.add(surface.points[v], place[v], distance[v]);
      const std::size_t most = std::clamp(kMostOfMean * left / (end - t), kLeastPieces, kMostPieces);
      left -= std::min(left, way.cover(piece, kFewPieces, most, [&](std::uint32_t at, double bound) {
        given[chunk].push_back({static_cast<std::uint32_t>(t), at, bound});
      }));
    }
  });
  std::vector<GivenPiece> all;
  for (const std::vector<GivenPiece>& chunk : given) all.insert(all.end(), chunk.begin(), chunk.end());
  return all;
}

template <std::size_t D>
double largest_coordinate(const ProductSurface<D>& surface) {
  double largest = 0.0;
  for (const ProductPoint<D>& point : surface.points) {
    for (const double value : point) largest = std::max(largest, std::abs(value));
  }
  return largest;
}

/// One step of the induction; `enough` and partners as above. \pre `known` is of the finer triangles
template <std::size_t D>
CertifiedGroup hand_on(const ProductSurface<D>& finer, std::span<const TriangleBound> known,
                       const ProductSurface<D>& coarser, double enough, const Partners& partners = {}) {
  const double coordinate = std::max(largest_coordinate(finer), largest_coordinate(coarser));
  return hand_on(
      known, coarser.triangles.size(), coordinate * kProductMargin,
      [&] { return cover_product_surface(finer, coarser, enough, partners.of_finer); },
      [&] { return cover_product_surface(coarser, finer, enough, partners.of_coarser); });
}

}  // namespace meshlode::builder
