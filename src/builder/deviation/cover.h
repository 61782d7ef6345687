// SPDX-License-Identifier: GPL-3.0-or-later
// What bounds are made of: a triangle of one surface is cut into convex pieces, and each piece is given to one triangle
// of another surface. The distance to a convex set is convex, so that no point of a piece is farther from its triangle
// than the piece's farthest corner. Where a piece is cut does not matter for the proof, only for how good it is.
//
// A `Target` is the other surface, in three dimensions or in more (certify.cpp, promise/product_cover.h):
//
//   Point, Place, Corners     a point; which triangle, comparable by ==; its corners
//   Plane                     with `double side(Point) const`, 0 on it and negative towards the first triangle
//   nearest(point, hint)      the place of the nearest triangle; of any, where that cannot be told
//   corners_at(place), distance2(point, corners), distance2_at(point, place)
//   bisector(one, other)      an optional Plane on whose sides two neighbours are nearer, roughly
//   middle(points), mix(a, b, share), length2(a, b)
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "builder/deviation/deviation.h"

namespace meshlode::builder {

/// Of pieces: a piece so deep is given away as it is.
constexpr int kMaxCoverDepth = 24;
/// Beyond so many cuts pieces are halved: lines of equal distance have not got them anywhere.
constexpr int kMaxCoverCuts = 16;

template <class Target>
class Cover {
 public:
  using Point = typename Target::Point;
  using Place = typename Target::Place;

  /// A convex polygon, and the nearest triangle of the other side to each corner.
  struct Piece {
    static constexpr std::size_t kMaxCorners = 10;
    std::array<Point, kMaxCorners> corner;
    std::array<Place, kMaxCorners> place;
    std::array<double, kMaxCorners> distance;  ///< to it
    std::size_t count = 0;
    int depth = 0;

    void add(const Point& p, Place at, double d) {
      corner[count] = p;
      place[count] = at;
      distance[count++] = d;
    }
  };

  /// A piece is good enough within a share of the `largest` distance of all vertices to their nearest triangle, and
  /// within `enough` in any case. The target must outlive this.
  explicit Cover(const Target& target, double largest = 0.0, double enough = 0.0)
      : target_(target), largest_(largest), enough_(enough) {}

  [[nodiscard]] double distance(const Point& p, Place place) const { return std::sqrt(target_.distance2_at(p, place)); }

  /// Calls give(place of a triangle of the other side, bound) for pieces that cover the one given. Returns how many
  /// were looked at. Where everything crosses everything, a triangle would fall into any number of pieces: beyond
  /// `max_pieces` each is given away as it is, and after `few_pieces` what is no farther than the farthest vertex. The
  /// bound still holds; it is only larger.
  template <class Give>
  std::size_t cover(const Piece& whole, std::size_t few_pieces, std::size_t max_pieces, const Give& give) {
    std::size_t pieces = 1;
    for (stack_.assign(1, whole); !stack_.empty(); ++pieces) {
      const Piece piece = stack_.back();
      stack_.pop_back();
      const double enough = pieces > few_pieces ? std::max(enough_, largest_) : enough_;
      const auto is_good = [&](double bound, double low) {
        return bound <= low * (1.0 + kTolerance) + kShareOfLargest * largest_ || bound <= enough;
      };
      double low = 0.0;
      for (std::size_t i = 0; i < piece.count; ++i) low = std::max(low, piece.distance[i]);
      // The one triangle that is best for all corners: of those that are near one of them, or near the middle (corners
      // that lie on corners of the other side say nothing about what is between them).
      Best best;
      for (std::size_t i = 0; i < piece.count && !is_good(best.bound, low); ++i)
        try_triangle(piece, piece.place[i], best);
      if (!is_good(best.bound, low)) {
        const Point middle = Target::middle(std::span(piece.corner).first(piece.count));
        try_triangle(piece, target_.nearest(middle, best.place), best);
      }
      if (is_good(best.bound, low) || piece.depth >= kMaxCoverDepth || pieces >= max_pieces) {
        give(best.place, best.bound);
        continue;
      }
      split(piece, best.place, piece.place[best.worst_corner]);
    }
    return pieces - 1;
  }

 private:
  // A piece is good enough when it is bounded to this share above its own farthest corner, or this share of the
  // largest.
  static constexpr double kTolerance = 0.05;
  static constexpr double kShareOfLargest = 0.03;

  struct Best {
    Place place{0U};
    std::size_t worst_corner = 0;
    double bound = std::numeric_limits<double>::infinity();
  };

  void try_triangle(const Piece& piece, Place place, Best& best) const {
    if (place == best.place && best.bound < std::numeric_limits<double>::infinity()) return;
    const typename Target::Corners corners = target_.corners_at(place);
    const double beaten2 = best.bound * best.bound;
    double farthest2 = -1.0;
    std::size_t corner = 0;
    for (std::size_t j = 0; j < piece.count; ++j) {
      const double d2 =
          piece.place[j] == place ? piece.distance[j] * piece.distance[j] : Target::distance2(piece.corner[j], corners);
      if (!(d2 <= farthest2)) {
        if (!(d2 < beaten2)) return;  // not a number either
        farthest2 = d2;
        corner = j;
      }
    }
    best = {place, corner, std::sqrt(farthest2)};
  }

  /// Along the line where two triangles are equally far, or through the middle of the longest edge.
  void split(const Piece& piece, Place one, Place other) {
    std::array<double, Piece::kMaxCorners> balance;  // negative: nearer to one
    bool has_one = false, has_other = false;
    if (piece.depth >= kMaxCoverCuts) return split_longest(piece);
    const std::optional<typename Target::Plane> plane =
        piece.depth < kMaxCoverCuts / 2 ? target_.bisector(one, other) : std::nullopt;
    for (std::size_t i = 0; i < piece.count; ++i) {
      balance[i] =
          plane ? plane->side(piece.corner[i]) : distance(piece.corner[i], one) - distance(piece.corner[i], other);
      has_one |= balance[i] < 0.0;
      has_other |= balance[i] > 0.0;
    }
    // Distances are not linear: where they balance more than twice along the outline, no line separates the two sides.
    std::size_t crossings = 0;
    for (std::size_t i = 0; i < piece.count; ++i)
      crossings += balance[i] * balance[(i + 1) % piece.count] < 0.0 ? 1 : 0;
    if (!has_one || !has_other || crossings > 2 || piece.count + 2 > Piece::kMaxCorners) return split_longest(piece);
    Piece a, b;
    a.depth = b.depth = piece.depth + 1;
    for (std::size_t i = 0; i < piece.count; ++i) {
      const std::size_t j = (i + 1) % piece.count;
      if (balance[i] <= 0.0) a.add(piece.corner[i], piece.place[i], piece.distance[i]);
      if (balance[i] >= 0.0) b.add(piece.corner[i], piece.place[i], piece.distance[i]);
      if (!(balance[i] * balance[j] < 0.0)) continue;
      const Point p = plane ? Target::mix(piece.corner[i], piece.corner[j], balance[i] / (balance[i] - balance[j]))
                            : find_balance(piece.corner[i], piece.corner[j], balance[i], balance[j], one, other);
      const Place place = target_.nearest(p, one);
      const double d = distance(p, place);
      a.add(p, place, d);
      b.add(p, place, d);
    }
    if (a.count < 3 || b.count < 3) return split_longest(piece);
    stack_.push_back(a);
    stack_.push_back(b);
  }

  void split_longest(const Piece& piece) {
    // A polygon is first cut from corner to corner, a triangle across its longest edge.
    Piece a, b;
    a.depth = b.depth = piece.depth + 1;
    if (piece.count > 3) {
      const std::size_t middle = piece.count / 2;
      for (std::size_t i = 0; i <= middle; ++i) a.add(piece.corner[i], piece.place[i], piece.distance[i]);
      for (std::size_t i = middle; i <= piece.count; ++i) {
        const std::size_t j = i % piece.count;
        b.add(piece.corner[j], piece.place[j], piece.distance[j]);
      }
    } else {
      std::size_t longest = 0;
      double longest2 = -1.0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double length2 = Target::length2(piece.corner[i], piece.corner[(i + 1) % 3]);
        if (length2 > longest2) {
          longest2 = length2;
          longest = i;
        }
      }
      const std::size_t i = longest, j = (i + 1) % 3, k = (i + 2) % 3;
      const Point p = Target::middle(std::array{piece.corner[i], piece.corner[j]});
      const Place place = target_.nearest(p, piece.place[i]);
      const double d = distance(p, place);
      a.add(piece.corner[i], piece.place[i], piece.distance[i]);
      a.add(p, place, d);
      a.add(piece.corner[k], piece.place[k], piece.distance[k]);
      b.add(p, place, d);
      b.add(piece.corner[j], piece.place[j], piece.distance[j]);
      b.add(piece.corner[k], piece.place[k], piece.distance[k]);
    }
    stack_.push_back(a);
    stack_.push_back(b);
  }

  [[nodiscard]] Point find_balance(Point a, Point b, double at_a, double at_b, Place one, Place other) const {
    for (int step = 0; step < 4; ++step) {
      const Point p = Target::mix(a, b, at_a / (at_a - at_b));
      const double at_p = distance(p, one) - distance(p, other);
      if (at_p == 0.0) return p;
      if ((at_p < 0.0) == (at_a < 0.0)) {
        a = p;
        at_a = at_p;
      } else {
        b = p;
        at_b = at_p;
      }
    }
    return Target::mix(a, b, at_a / (at_a - at_b));
  }

  const Target& target_;
  double largest_, enough_;
  std::vector<Piece> stack_;
};

/// A piece of one side's triangle `from`, given to the other side's triangle `to`.
struct GivenPiece {
  std::uint32_t from, to;
  double bound;
};

/// A bound with what doubles may have lost on the way to it added, and `slack`, which is the largest coordinate's
/// share. What is not a number, or not finite, is no bound.
[[nodiscard]] inline double rounded_up(double bound, double slack) {
  constexpr double kRelativeMargin = 0x1p-49;  // 16u: roots, squares, sums and this margin itself
  const double up = bound * (1.0 + kRelativeMargin) + slack;
  return up <= std::numeric_limits<double>::max() ? up : std::numeric_limits<double>::infinity();
}

/// One step of the induction (certify.cpp): from what is proven of finer triangles to what is proven of the coarser
/// ones that replace them. cover_finer() and cover_coarser() give the pieces that cover all of either side; they are
/// not asked where there is nothing on one.
template <class CoverFiner, class CoverCoarser>
[[nodiscard]] CertifiedGroup hand_on(std::span<const TriangleBound> finer, std::size_t coarser_count, double slack,
                                     const CoverFiner& cover_finer, const CoverCoarser& cover_coarser) {
  CertifiedGroup result;
  result.bounds.resize(coarser_count);
  if (finer.empty() || coarser_count == 0) {
    if (finer.size() != coarser_count) result.deviation = std::numeric_limits<double>::infinity();
    for (TriangleBound& bound : result.bounds) bound.to_source = result.deviation;
    return result;
  }
  for (const GivenPiece& piece : cover_finer()) {
    double& known = result.bounds[piece.to].from_source;
    known = std::max(known, rounded_up(finer[piece.from].from_source + piece.bound, slack));
  }
  for (const GivenPiece& piece : cover_coarser()) {
    double& known = result.bounds[piece.from].to_source;
    known = std::max(known, rounded_up(piece.bound + finer[piece.to].to_source, slack));
  }
  for (const TriangleBound& bound : result.bounds)
    result.deviation = std::max({result.deviation, bound.from_source, bound.to_source});
  return result;
}

}  // namespace meshlode::builder
