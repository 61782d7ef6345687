// SPDX-License-Identifier: GPL-3.0-or-later
// The certified tier for what is promised (docs/selection.md, "What is promised"): the induction of
// deviation/certify.cpp over the finished DAG, in the product space, where triangles are as flat as in three
// dimensions. Level 0 is covered by the source and the source by level 0; then each group hands on what is proven of
// the triangles of its members to the triangles that were made of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/parallel.h"
#include "base/vec.h"
#include "build/deviation/cover.h"
#include "build/deviation/deviation.h"
#include "build/lod_dag.h"
#include "build/promise/painted_source.h"
#include "build/promise/product_point.h"
#include "build/promise/product_surfaces.h"
#include "build/promise/product_tree.h"
#include "format/grid.h"

namespace meshlode::build {

/// Per group, object units of the product space, without a margin; and of level 0 alone.
struct ProductDeviations {
  std::vector<double> groups;
  double level0 = 0.0;
};

template <std::size_t D>
class PromiseCertifier {
 public:
  /// What is given must outlive this. `quantization`: what it moves a point by; pieces of level 0 that are so near are
  /// good enough.
  PromiseCertifier(const ProductSurfaces<D>& surfaces, const LodDag& dag, const format::PositionGrid& grid,
                   double quantization)
      : surfaces_(surfaces), dag_(dag), grid_(grid), quantization_(quantization) {}

  /// \pre the source has on_grid
  [[nodiscard]] ProductDeviations certify(const PaintedSource& source) const {
    ProductDeviations found;
    found.groups.assign(dag_.groups.size(), 0.0);
    std::vector<std::vector<TriangleBound>> bounds(dag_.clusters.size());
    found.level0 = certify_level0(source, bounds);
    std::vector<std::vector<std::uint32_t>> outputs(dag_.groups.size());
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (dag_.clusters[c].own_group.is_valid()) outputs[dag_.clusters[c].own_group.value].push_back(c);
    }
    std::uint32_t level_count = 0;
    for (const DagGroup& group : dag_.groups) level_count = std::max(level_count, group.level + 1);
    for (std::uint32_t level = 0; level < level_count; ++level) {
      std::vector<std::uint32_t> groups;
      for (std::uint32_t g = 0; g < dag_.groups.size(); ++g) {
        if (dag_.groups[g].level == level && !dag_.groups[g].is_terminal) groups.push_back(g);
      }
      // Clusters belong to one group, and are made from one: nobody else writes there.
      parallel_for_each_index(groups.size(), 1, [&](std::size_t i) {
        found.groups[groups[i]] = certify_group(dag_.groups[groups[i]], outputs[groups[i]], bounds);
      });
    }
    return found;
  }

  struct Step {
    std::vector<TriangleBound> bounds;  ///< per coarser triangle
    double deviation = 0.0;             ///< the largest of them
  };

  /// Of triangles that are the same one on both sides, but for what quantization moves: of each the other's, or kNoId.
  struct Partners {
    std::vector<std::uint32_t> of_finer, of_coarser;
  };

  /// From what is proven of the triangles of `finer` to what is proven of those of `coarser`. Pieces that are within
  /// `enough` are good enough; whole triangles of their partners, where there are any.
  [[nodiscard]] static Step hand_on(const ProductSurface<D>& finer, std::span<const TriangleBound> known,
                                    const ProductSurface<D>& coarser, double enough, const Partners& partners = {}) {
    Step step;
    step.bounds.resize(coarser.triangles.size());
    if (finer.triangles.empty() || coarser.triangles.empty()) {
      if (finer.triangles.size() != coarser.triangles.size()) step.deviation = std::numeric_limits<double>::infinity();
      for (TriangleBound& bound : step.bounds) bound.to_source = step.deviation;
      return step;
    }
    const double coordinate = std::max(largest_coordinate(finer), largest_coordinate(coarser));
    const auto sum = [&](double before, double on) { return rounded_up(before + on, coordinate, kCoordinateMargin); };
    std::vector<std::vector<Handed>> handed(chunk_count(finer.triangles.size(), kChunk));
    cover_surface(finer, Target(coarser), enough, partners.of_finer,
                  [&](std::size_t chunk, std::size_t t, std::uint32_t at, double bound) {
                    handed[chunk].push_back({at, sum(known[t].from_source, bound)});
                  });
    for (const auto& chunk : handed) {
      for (const auto& [triangle, bound] : chunk)
        step.bounds[triangle].from_source = std::max(step.bounds[triangle].from_source, bound);
    }
    cover_surface(coarser, Target(finer), enough, partners.of_coarser,
                  [&](std::size_t, std::size_t t, std::uint32_t at, double bound) {
                    step.bounds[t].to_source = std::max(step.bounds[t].to_source, sum(known[at].to_source, bound));
                  });
    for (const TriangleBound& bound : step.bounds)
      step.deviation = std::max({step.deviation, bound.from_source, bound.to_source});
    return step;
  }

 private:
  using Point = ProductPoint<D>;
  using Surface = ProductSurface<D>;
  using Bounds = std::vector<std::vector<TriangleBound>>;  // per cluster, of the triangles that has_points()

  // What doubles may lose in one step, with u = 2^-53 and C the largest coordinate: each coordinate of a distance
  // (product_distance2) is off by 12 roundings of numbers of 2C at most, and the weights by 2u of an edge: √14 · 28u C
  // < 105u C. New corners of pieces, as in certify.cpp with √14 for √3: 1560u C. Sums and roots: rounded_up().
  static constexpr double kCoordinateMargin = 0x1p-42;  // 2048u, of C

  static constexpr std::size_t kChunk = 256;  // triangles that share a hint, whatever the thread count
  // Of a triangle: on the average, so many times what is left for each at most, and in any case. Where a texture is
  // chaos every triangle is far from all others and near to none, and each search looks at nearly all.
  static constexpr std::size_t kPieces = 32, kMostOfMean = 8, kLeastPieces = 8, kMostPieces = 512;
  static constexpr std::size_t kFewPieces = 16;  // as Cover's

  class Target {
   public:
    using Point = ProductPoint<D>;
    using Place = std::uint32_t;
    struct Corners {
      const Point *a, *b, *c;
    };
    struct Plane {
      [[nodiscard]] double side(const Point&) const { return 0.0; }
    };

    explicit Target(const Surface& surface) : surface_(surface), tree_(surface) {}

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
    const Surface& surface_;
    ProductTree<D> tree_;
  };

  struct Handed {
    std::uint32_t triangle;
    double bound;
  };

  /// give(chunk, triangle, triangle of the other side, bound) for pieces that cover all triangles of a surface; chunks
  /// go side by side. `partners`: none or one for each.
  template <class Give>
  static void cover_surface(const Surface& surface, const Target& target, double enough,
                            std::span<const std::uint32_t> partners, const Give& give) {
    const std::size_t count = surface.triangles.size();
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
          give(chunk, t, partners[t], std::sqrt(farthest2));
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
      Cover<Target> way(target, largest, enough);
      std::size_t left = kPieces * (end - begin);
      for (std::size_t t = begin; t < end; ++t) {
        if (is_covered[t] != 0) continue;
        typename Cover<Target>::Piece piece;
        for (const std::uint32_t v : surface.triangles[t]) piece.add(surface.points[v], place[v], distance[v]);
        const std::size_t most = std::clamp(kMostOfMean * left / (end - t), kLeastPieces, kMostPieces);
        left -= std::min(left, way.cover(piece, kFewPieces, most,
                                         [&](std::uint32_t at, double bound) { give(chunk, t, at, bound); }));
      }
    });
  }

  [[nodiscard]] static double largest_coordinate(const Surface& surface) {
    double largest = 0.0;
    for (const Point& point : surface.points) {
      for (const double value : point) largest = std::max(largest, std::abs(value));
    }
    return largest;
  }

  /// The triangles of some clusters that something is measured of, and how many each has.
  struct Triangles {
    Surface surface;
    std::vector<std::size_t> count;  ///< per cluster
  };
  [[nodiscard]] Triangles triangles_of(std::span<const std::uint32_t> clusters) const {
    Triangles out;
    for (const std::uint32_t c : clusters) {
      const std::size_t first = out.surface.triangles.size();
      surfaces_.add_cluster(dag_.clusters[c], out.surface);
      leave_out_pointless(out.surface, first);
      out.count.push_back(out.surface.triangles.size() - first);
    }
    return out;
  }
  /// Of the triangles from `first` on. Returns which are left, counted from there.
  std::vector<std::uint32_t> leave_out_pointless(Surface& surface, std::size_t first) const {
    std::vector<std::uint32_t> kept;
    for (std::size_t t = first; t < surface.triangles.size(); ++t) {
      if (!surfaces_.has_points(surface, static_cast<std::uint32_t>(t))) continue;
      surface.triangles[first + kept.size()] = surface.triangles[t];
      kept.push_back(static_cast<std::uint32_t>(t - first));
    }
    surface.triangles.resize(first + kept.size());
    return kept;
  }

  /// A triangle by where the grid has its corners, whichever is called its first.
  using GridCorners = std::array<std::array<double, 3>, 3>;
  static GridCorners least_turn(const GridCorners& corners) {
    const auto& [a, b, c] = corners;
    return std::min({corners, GridCorners{b, c, a}, GridCorners{c, a, b}});
  }

  /// `numbers`: of the source's triangles in `painted`.
  [[nodiscard]] Partners find_partners(const PaintedSource& painted, std::span<const std::uint32_t> numbers,
                                       const Surface& level0) const {
    std::vector<std::pair<GridCorners, std::uint32_t>> known(level0.triangles.size());
    parallel_for_each_index(known.size(), kLoopGrain, [&](std::size_t t) {
      GridCorners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Point& p = level0.points[level0.triangles[t][k]];
        corners[k] = {p[0], p[1], p[2]};
      }
      known[t] = {least_turn(corners), static_cast<std::uint32_t>(t)};
    });
    std::sort(known.begin(), known.end());
    Partners partners{std::vector<std::uint32_t>(numbers.size(), kNoId),
                      std::vector<std::uint32_t>(known.size(), kNoId)};
    std::vector<std::uint32_t> taken(known.size(), 0);  // of those from here on that are in the same place
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      GridCorners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p = grid_.decode(painted.on_grid[painted.wedges[numbers[i]][k]]);
        corners[k] = {p.x, p.y, p.z};
      }
      // Of triangles in the same place, which differ in what is painted on them, each has its own.
      const std::pair<GridCorners, std::uint32_t> wanted{least_turn(corners), 0};
      const auto first = static_cast<std::size_t>(std::lower_bound(known.begin(), known.end(), wanted) - known.begin());
      if (first == known.size()) continue;
      const std::size_t next = first + taken[first];
      if (next >= known.size() || known[next].first != wanted.first) continue;
      ++taken[first];
      partners.of_finer[i] = known[next].second;
      partners.of_coarser[known[next].second] = static_cast<std::uint32_t>(i);
    }
    return partners;
  }

  static void keep(std::span<const std::uint32_t> clusters, const Triangles& of, const Step& step, Bounds& bounds) {
    auto begin = step.bounds.begin();
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const auto end = begin + static_cast<std::ptrdiff_t>(of.count[i]);
      bounds[clusters[i]].assign(begin, end);
      begin = end;
    }
  }

  double certify_level0(const PaintedSource& painted, Bounds& bounds) const {
    std::vector<std::uint32_t> clusters;
    for (std::uint32_t c = 0; c < dag_.clusters.size(); ++c) {
      if (!dag_.clusters[c].own_group.is_valid()) clusters.push_back(c);
    }
    const Triangles level0 = triangles_of(clusters);
    Surface source = surfaces_.of_source(painted);
    const std::vector<std::uint32_t> numbers = leave_out_pointless(source, 0);
    const std::vector<TriangleBound> nothing(source.triangles.size());
    const Step step =
        hand_on(source, nothing, level0.surface, quantization_, find_partners(painted, numbers, level0.surface));
    keep(clusters, level0, step, bounds);
    return step.deviation;
  }

  /// Takes the bounds of the members, leaves those of what was made of them.
  double certify_group(const DagGroup& group, std::span<const std::uint32_t> outputs, Bounds& bounds) const {
    std::vector<std::uint32_t> members(group.cluster_count);
    std::vector<TriangleBound> known;
    for (std::uint32_t i = 0; i < group.cluster_count; ++i) {
      const std::uint32_t c = members[i] = group.first_cluster + i;
      known.insert(known.end(), bounds[c].begin(), bounds[c].end());
      bounds[c] = {};
    }
    const Triangles finer = triangles_of(members), coarser = triangles_of(outputs);
    const Step step = hand_on(finer.surface, known, coarser.surface, 0.0);
    keep(outputs, coarser, step, bounds);
    return step.deviation;
  }

  const ProductSurfaces<D>& surfaces_;
  const LodDag& dag_;
  format::PositionGrid grid_;
  double quantization_;
};

}  // namespace meshlode::build
