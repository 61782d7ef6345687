// SPDX-License-Identifier: GPL-3.0-or-later
// The certified tier: a bound that every point keeps, on both sides, by induction over the levels.
//
// A triangle t of a level has two numbers: every point of the source that was handed to t is within `from_source` of t,
// and every point of t is within `to_source` of the source. One simplification hands them on. Each triangle of one side
// is cut into convex pieces, each piece is given to one triangle T of the other side, and since the distance to a
// convex set is convex, no point of the piece is farther from T than its farthest corner: s. By the triangle inequality
// the source points of t that lie nearest to the piece are within from_source(t) + s of T, and the points of a piece of
// T within s + to_source(t) of the source. Where a piece is cut does not matter for the proof, only for how good it is.
//
// Handing over to single triangles is what makes the bound hold for every cut, which may draw one cluster of a group
// and replace another.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "build/deviation/deviation.h"
#include "build/deviation/surface_tree.h"

namespace meshlode::build {

namespace {

constexpr std::size_t kMaxCorners = 10;
constexpr int kMaxDepth = 24;  // of cuts; a piece that deep is given away as it is
constexpr int kMaxCuts = 16;   // beyond, pieces are halved: lines of equal distance have not got them anywhere
// Where everything crosses everything, a triangle would fall into any number of pieces: beyond so many each is given
// away as it is. The bound still holds; it is only larger.
constexpr std::size_t kMaxPieces = 512;
// A piece is good enough when it is bounded to this share above its own farthest corner, or this share of the largest.
constexpr double kTolerance = 0.05;
constexpr double kShareOfLargest = 0.03;
// What doubles may lose in one simplification, with u = 2^-53 and C the largest coordinate (relative to the origin):
// a distance 8u of itself and 9u of the triangle's longest edge, which is 2√3 C at most (point_distance.h): 31u C. A
// new corner of a piece 1.8u C where an edge is halved, 8.7u C where a plane cuts it and five times that where the cut
// is searched for (find_balance): over kMaxDepth cuts, kMaxCuts of them not halvings, 16 · 44 + 8 · 1.8 < 720u C. A
// point of the triangle is that near to the hull of a piece, whose corners bound its distance. Roots, squares, sums and
// this margin itself: 8u. And at level 0 the source's corners relative to the origin: 2u C.
constexpr double kRelativeMargin = 0x1p-49;    // 16u
constexpr double kCoordinateMargin = 0x1p-43;  // 1024u, of C

/// The margin added; what is not a number, or not finite, is no bound.
double rounded_up(double bound, double largest_coordinate) {
  const double up = bound * (1.0 + kRelativeMargin) + largest_coordinate * kCoordinateMargin;
  return up <= std::numeric_limits<double>::max() ? up : std::numeric_limits<double>::infinity();
}

/// The larger one, or what is not a number.
double larger(double a, double b) {
  return b <= a ? a : b;
}

struct Piece {
  std::array<Vec3d, kMaxCorners> corner;
  std::array<TreeSlot, kMaxCorners> place;   ///< of the nearest triangle of the other side
  std::array<double, kMaxCorners> distance;  ///< to it
  std::size_t count = 0;
  int depth = 0;

  void add(const Vec3d& p, TreeSlot at, double d) {
    corner[count] = p;
    place[count] = at;
    distance[count++] = d;
  }
};

class OneWay {
 public:
  explicit OneWay(const SurfaceTree& tree) : tree_(tree) {}

  [[nodiscard]] double distance(const Vec3d& p, TreeSlot place) const {
    return std::sqrt(tree_.distance2_at(p, place));
  }
  [[nodiscard]] TreeSlot nearest(const Vec3d& p, TreeSlot hint) const {
    const Vec3f at = tree_.to_frame(p);
    const TreeSlot place = tree_.find_nearest(at, tree_.look_around(at, hint, {}), 0.0F).slot;
    return place.is_valid() ? place : hint;
  }

  double largest = 0.0;  ///< of all vertices, to their nearest triangle

  /// Calls give(triangle of the other side, bound) for pieces that cover the one given.
  template <class Give>
  void cover(const Piece& whole, const Give& give) {
    stack_.assign(1, whole);
    for (std::size_t pieces = 1; !stack_.empty(); ++pieces) {
      const Piece piece = stack_.back();
      stack_.pop_back();
      double low = 0.0;
      for (std::size_t i = 0; i < piece.count; ++i) low = std::max(low, piece.distance[i]);
      // The one triangle that is best for all corners: of those that are near one of them, or near the middle (corners
      // that lie on corners of the other side say nothing about what is between them).
      Best best;
      for (std::size_t i = 0; i < piece.count && !is_good(best.bound, low); ++i)
        try_triangle(piece, piece.place[i], best);
      if (!is_good(best.bound, low)) {
        Vec3d middle(0.0);
        for (std::size_t i = 0; i < piece.count; ++i) middle += piece.corner[i];
        try_triangle(piece, nearest(middle / static_cast<double>(piece.count), best.place), best);
      }
      if (is_good(best.bound, low) || piece.depth >= kMaxDepth || pieces >= kMaxPieces) {
        give(tree_.triangle_at(best.place), best.bound);
        continue;
      }
      split(piece, best.place, piece.place[best.worst_corner]);
    }
  }

 private:
  struct Best {
    TreeSlot place{0U};
    std::size_t worst_corner = 0;
    double bound = std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] bool is_good(double bound, double low) const {
    return bound <= low * (1.0 + kTolerance) + kShareOfLargest * largest;
  }

  void try_triangle(const Piece& piece, TreeSlot place, Best& best) const {
    if (place == best.place && best.bound < std::numeric_limits<double>::infinity()) return;
    const TriangleCorners corners = tree_.corners_at(place);
    const double beaten2 = best.bound * best.bound;
    double farthest2 = -1.0;
    std::size_t corner = 0;
    for (std::size_t j = 0; j < piece.count; ++j) {
      const double d2 = piece.place[j] == place ? piece.distance[j] * piece.distance[j]
                                                : point_triangle_distance2(piece.corner[j], corners);
      if (!(d2 <= farthest2)) {
        if (!(d2 < beaten2)) return;  // not a number either
        farthest2 = d2;
        corner = j;
      }
    }
    best = {place, corner, std::sqrt(farthest2)};
  }

  /// Along the line where two triangles are equally far, or through the middle of the longest edge.
  void split(const Piece& piece, TreeSlot one, TreeSlot other) {
    std::array<double, kMaxCorners> balance;  // negative: nearer to one
    bool has_one = false, has_other = false;
    if (piece.depth >= kMaxCuts) return split_longest(piece);
    const std::optional<Plane> plane = piece.depth < kMaxCuts / 2 ? find_bisector(one, other) : std::nullopt;
    for (std::size_t i = 0; i < piece.count; ++i) {
      balance[i] = plane ? glm::dot(piece.corner[i] - plane->point, plane->normal)
                         : distance(piece.corner[i], one) - distance(piece.corner[i], other);
      has_one |= balance[i] < 0.0;
      has_other |= balance[i] > 0.0;
    }
    // Distances are not linear: where they balance more than twice along the outline, no line separates the two sides.
    std::size_t crossings = 0;
    for (std::size_t i = 0; i < piece.count; ++i)
      crossings += balance[i] * balance[(i + 1) % piece.count] < 0.0 ? 1 : 0;
    if (!has_one || !has_other || crossings > 2 || piece.count + 2 > kMaxCorners) return split_longest(piece);
    Piece a, b;
    a.depth = b.depth = piece.depth + 1;
    for (std::size_t i = 0; i < piece.count; ++i) {
      const std::size_t j = (i + 1) % piece.count;
      if (balance[i] <= 0.0) a.add(piece.corner[i], piece.place[i], piece.distance[i]);
      if (balance[i] >= 0.0) b.add(piece.corner[i], piece.place[i], piece.distance[i]);
      if (!(balance[i] * balance[j] < 0.0)) continue;
      const Vec3d p =
          plane ? piece.corner[i] + (piece.corner[j] - piece.corner[i]) * (balance[i] / (balance[i] - balance[j]))
                : find_balance(piece.corner[i], piece.corner[j], balance[i], balance[j], one, other);
      const TreeSlot place = nearest(p, one);
      const double d = distance(p, place);
      a.add(p, place, d);
      b.add(p, place, d);
    }
    if (a.count < 3 || b.count < 3) return split_longest(piece);
    stack_.push_back(a);
    stack_.push_back(b);
  }

  struct Plane {
    Vec3d point, normal;
  };

  /// Of two triangles with a common edge: the plane through it halfway between them, its normal towards `other`.
  [[nodiscard]] std::optional<Plane> find_bisector(TreeSlot one, TreeSlot other) const {
    const auto& t = tree_.indices_at(one);
    const auto& u = tree_.indices_at(other);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        if (t[i] != u[(j + 1) % 3] || t[(i + 1) % 3] != u[j]) continue;
        const TriangleCorners a = tree_.corners_at(one), b = tree_.corners_at(other);
        const Vec3d edge = a[(i + 1) % 3] - a[i];
        const Vec3d n = unit(glm::cross(a[1] - a[0], a[2] - a[0])) + unit(glm::cross(b[1] - b[0], b[2] - b[0]));
        return Plane{a[i], glm::cross(edge, n)};
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] static Vec3d unit(const Vec3d& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : v;
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
        const Vec3d edge = piece.corner[(i + 1) % 3] - piece.corner[i];
        if (glm::dot(edge, edge) > longest2) {
          longest2 = glm::dot(edge, edge);
          longest = i;
        }
      }
      const std::size_t i = longest, j = (i + 1) % 3, k = (i + 2) % 3;
      const Vec3d p = (piece.corner[i] + piece.corner[j]) * 0.5;
      const TreeSlot place = nearest(p, piece.place[i]);
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

  [[nodiscard]] Vec3d find_balance(Vec3d a, Vec3d b, double at_a, double at_b, TreeSlot one, TreeSlot other) const {
    for (int step = 0; step < 4; ++step) {
      const Vec3d p = a + (b - a) * (at_a / (at_a - at_b));
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
    return a + (b - a) * (at_a / (at_a - at_b));
  }

  const SurfaceTree& tree_;
  std::vector<Piece> stack_;
};

/// Covers every triangle of a surface; give(triangle, triangle of the other side, bound).
template <class Give>
void cover_surface(const GroupSurface& surface, const SurfaceTree& other, const Give& give) {
  OneWay way(other);
  std::vector<TreeSlot> place(surface.positions.size());
  std::vector<double> distance(surface.positions.size(), 0.0);
  TreeSlot hint{0U};
  for (const auto& t : surface.triangles) {
    for (const std::uint32_t v : t) {
      if (place[v].is_valid()) continue;
      hint = place[v] = way.nearest(surface.positions[v], hint);
      distance[v] = way.distance(surface.positions[v], hint);
      way.largest = std::max(way.largest, distance[v]);
    }
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    Piece piece;
    for (const std::uint32_t v : surface.triangles[t]) piece.add(surface.positions[v], place[v], distance[v]);
    way.cover(piece, [&](std::uint32_t target, double bound) { give(t, target, bound); });
  }
}

double largest_coordinate(const GroupSurface& surface) {
  double largest = 0.0;
  for (const auto& t : surface.triangles) {
    for (const std::uint32_t v : t) {
      const Vec3d p = glm::abs(surface.positions[v]);
      largest = std::max(largest, std::max(p.x, std::max(p.y, p.z)));
    }
  }
  return largest;
}

}  // namespace

CertifiedGroup certify_group(const GroupSurface& finer, std::span<const TriangleBound> finer_bounds,
                             const GroupSurface& coarser) {
  CertifiedGroup result;
  result.bounds.resize(coarser.triangles.size());
  if (finer.triangles.empty() || coarser.triangles.empty()) {
    if (finer.triangles.size() != coarser.triangles.size()) result.deviation = std::numeric_limits<double>::infinity();
    for (TriangleBound& bound : result.bounds) bound.to_source = result.deviation;
    return result;
  }
  SurfaceTree finer_tree, coarser_tree;
  finer_tree.build({finer.positions, finer.triangles});
  coarser_tree.build({coarser.positions, coarser.triangles});
  const double coordinate = std::max(largest_coordinate(finer), largest_coordinate(coarser));
  cover_surface(finer, coarser_tree, [&](std::size_t t, std::uint32_t target, double bound) {
    double& known = result.bounds[target].from_source;
    known = std::max(known, rounded_up(finer_bounds[t].from_source + bound, coordinate));
  });
  cover_surface(coarser, finer_tree, [&](std::size_t t, std::uint32_t target, double bound) {
    double& known = result.bounds[t].to_source;
    known = std::max(known, rounded_up(bound + finer_bounds[target].to_source, coordinate));
  });
  for (const TriangleBound& bound : result.bounds) {
    result.deviation = std::max(result.deviation, std::max(bound.from_source, bound.to_source));
  }
  return result;
}

TriangleBound initial_bound(const TriangleCorners3& exact, const TriangleCorners3& on_grid) {
  double largest2 = 0.0, coordinate = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d moved = exact[k] - on_grid[k];
    largest2 = larger(largest2, glm::dot(moved, moved));
    const Vec3d p = glm::abs(exact[k]);
    coordinate = larger(coordinate, std::max(p.x, std::max(p.y, p.z)));
  }
  const double bound = rounded_up(std::sqrt(largest2), coordinate);
  return {bound, bound};
}

}  // namespace meshlode::build
