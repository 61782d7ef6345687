// SPDX-License-Identifier: GPL-3.0-or-later
// The certified tier: a bound that every point keeps, on both sides, by induction over the levels.
//
// A triangle t of a level has two numbers: every point of the source that was handed to t is within `from_source` of t,
// and every point of t is within `to_source` of the source. One simplification hands them on. Each triangle of one side
// is covered by pieces, each given to one triangle T of the other side (cover.h), and no point of the piece is farther
// from T than its farthest corner: s. By the triangle inequality the source points of t that lie nearest to the piece
// are within from_source(t) + s of T, and the points of a piece of T within s + to_source(t) of the source.
//
// Handing over to single triangles is what makes the bound hold for every cut, which may draw one cluster of a group
// and replace another.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "builder/deviation/cover.h"
#include "builder/deviation/deviation.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

namespace {

// What doubles may lose in one simplification, with u = 2^-53 and C the largest coordinate (relative to the origin):
// a distance 8u of itself and 9u of the triangle's longest edge, which is 2√3 C at most (point_distance.h): 31u C. A
// new corner of a piece 1.8u C where an edge is halved, 8.7u C where a plane cuts it and five times that where the cut
// is searched for (find_balance): over kMaxCoverDepth cuts, kMaxCoverCuts of them not halvings, 16 · 44 + 8 · 1.8 <
// 720u C. A point of the triangle is that near to the hull of a piece, whose corners bound its distance. And at level 0
// the source's corners relative to the origin: 2u C.
constexpr double kCoordinateMargin = 0x1p-43;  // 1024u, of C

// Of a triangle. Beyond the first what is no farther than the farthest vertex is good enough: of meshes where
// everything crosses everything a build takes a fifth of the time, and of others the bounds stay what they were or
// nearly so.
constexpr std::size_t kFewPieces = 64, kMaxPieces = 512;

/// The larger one, or what is not a number.
double larger(double a, double b) {
  return b <= a ? a : b;
}

/// A group's surface, for Cover.
class GroupTarget {
 public:
  using Point = Vec3d;
  using Place = TreeSlot;
  using Corners = TriangleCorners;
  struct Plane {
    Vec3d point, normal;
    [[nodiscard]] double side(const Vec3d& p) const { return glm::dot(p - point, normal); }
  };

  explicit GroupTarget(const SurfaceTree& tree) : tree_(tree) {}

  [[nodiscard]] TreeSlot nearest(const Vec3d& p, TreeSlot hint) const {
    const Vec3f at = tree_.to_frame(p);
    const TreeSlot place = tree_.find_nearest(at, tree_.look_around(at, hint, {}), 0.0F).slot;
    return place.is_valid() ? place : hint;
  }
  [[nodiscard]] TriangleCorners corners_at(TreeSlot place) const { return tree_.corners_at(place); }
  [[nodiscard]] double distance2_at(const Vec3d& p, TreeSlot place) const { return tree_.distance2_at(p, place); }
  [[nodiscard]] static double distance2(const Vec3d& p, const TriangleCorners& corners) {
    return point_triangle_distance2(p, corners);
  }

  /// Of two triangles with a common edge: the plane through it halfway between them, its normal towards `other`.
  [[nodiscard]] std::optional<Plane> bisector(TreeSlot one, TreeSlot other) const {
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

  [[nodiscard]] static Vec3d middle(std::span<const Vec3d> points) {
    Vec3d sum(0.0);
    for (const Vec3d& p : points) sum += p;
    return sum / static_cast<double>(points.size());
  }
  [[nodiscard]] static Vec3d mix(const Vec3d& a, const Vec3d& b, double share) { return a + (b - a) * share; }
  [[nodiscard]] static double length2(const Vec3d& a, const Vec3d& b) { return glm::dot(b - a, b - a); }

 private:
  [[nodiscard]] static Vec3d unit(const Vec3d& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : v;
  }

  const SurfaceTree& tree_;
};

/// Pieces that cover every triangle of a surface.
std::vector<GivenPiece> cover_surface(const GroupSurface& surface, const GroupSurface& by) {
  SurfaceTree tree;
  tree.build({by.positions, by.triangles});
  const GroupTarget target(tree);
  std::vector<TreeSlot> place(surface.positions.size());
  std::vector<double> distance(surface.positions.size(), 0.0);
  double largest = 0.0;
  TreeSlot hint{0U};
  for (const auto& t : surface.triangles) {
    for (const std::uint32_t v : t) {
      if (place[v].is_valid()) continue;
      hint = place[v] = target.nearest(surface.positions[v], hint);
      distance[v] = std::sqrt(target.distance2_at(surface.positions[v], hint));
      largest = std::max(largest, distance[v]);
    }
  }
  Cover<GroupTarget> way(target, largest);
  std::vector<GivenPiece> pieces;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Cover<GroupTarget>::Piece piece;
    for (const std::uint32_t v : surface.triangles[t]) piece.add(surface.positions[v], place[v], distance[v]);
    way.cover(piece, kFewPieces, kMaxPieces, [&](TreeSlot at, double bound) {
      pieces.push_back({t, tree.triangle_at(at), bound});
    });
  }
  return pieces;
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
  const double coordinate = std::max(largest_coordinate(finer), largest_coordinate(coarser));
  return hand_on(
      finer_bounds, coarser.triangles.size(), coordinate * kCoordinateMargin,
      [&] { return cover_surface(finer, coarser); }, [&] { return cover_surface(coarser, finer); });
}

TriangleBound initial_bound(const TriangleCorners3& exact, const TriangleCorners3& on_grid) {
  double largest2 = 0.0, coordinate = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d moved = exact[k] - on_grid[k];
    largest2 = larger(largest2, glm::dot(moved, moved));
    const Vec3d p = glm::abs(exact[k]);
    coordinate = larger(coordinate, std::max(p.x, std::max(p.y, p.z)));
  }
  const double bound = rounded_up(std::sqrt(largest2), coordinate * kCoordinateMargin);
  return {bound, bound};
}

}  // namespace meshlode::builder
