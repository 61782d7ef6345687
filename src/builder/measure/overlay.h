// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle laid over a surface: cut where it passes from one triangle of the surface to the next, halfway between
// the two. The distance to one triangle is convex, so that a piece is nowhere farther from the triangle that it lies
// over than its corners are: these are the corners of the overlay of both, and the largest distance is at one of them.
// What a piece lies over need not be what is nearest to it. Then the bound is too large, never too small.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <deque>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "base/parallel.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

/// Of unit length or 0.
[[nodiscard]] inline Vec3f unit_normal(const TriangleCorners& corners) {
  const Vec3d n = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const double length = glm::length(n);
  return length > 0.0 ? Vec3f(n / length) : Vec3f(0.0F);
}

/// A surface that another one is laid over.
struct LinkedSurface {
  using Triangle = std::array<std::uint32_t, 3>;
  std::span<const Vec3d> positions;
  std::span<const Triangle> triangles;
  /// Per triangle and edge, from that corner to the next: 4 times the triangle beyond and the edge's number there;
  /// kNoId: a border, or more than two meet.
  std::span<const Triangle> neighbor;
  std::span<const Vec3f> normal;  ///< per triangle: unit_normal(); empty: made whenever they are looked at
  const SurfaceTree& tree;
  std::span<const TreeSlot> slot;  ///< per triangle

  [[nodiscard]] TriangleCorners corners(std::uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
  [[nodiscard]] Vec3f normal_of(std::uint32_t triangle) const {
    return normal.empty() ? unit_normal(corners(triangle)) : normal[triangle];
  }
};

/// LinkedSurface::neighbor. `id(corner)`: below id_count; equal where two corners are in one place.
template <class Id>
[[nodiscard]] std::vector<LinkedSurface::Triangle> link_edges(std::span<const LinkedSurface::Triangle> triangles,
                                                              std::size_t id_count, const Id& id) {
  // The edges of each place that it is the lesser end of: the first here, the next in `neighbor`.
  std::vector<std::uint32_t> first(id_count, kNoId);
  std::vector<LinkedSurface::Triangle> neighbor(triangles.size());
  for (std::uint32_t k = 0; k < triangles.size(); ++k) {
    const LinkedSurface::Triangle ids{id(triangles[k][0]), id(triangles[k][1]), id(triangles[k][2])};
    for (std::uint32_t e = 0; e < 3; ++e) {
      neighbor[k][e] = std::exchange(first[std::min(ids[e], ids[(e + 1) % 3])], 4 * k + e);
    }
  }
  parallel_for_each_chunk(id_count, kLoopGrain, [&](std::size_t, std::size_t begin, std::size_t last) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // other end, edge
    for (std::size_t from = begin; from < last; ++from) {
      edges.clear();
      for (std::uint32_t edge = first[from]; edge != kNoId;) {
        const LinkedSurface::Triangle& t = triangles[edge / 4];
        edges.emplace_back(std::max(id(t[edge % 4]), id(t[(edge % 4 + 1) % 3])), edge);
        edge = std::exchange(neighbor[edge / 4][edge % 4], kNoId);
      }
      std::sort(edges.begin(), edges.end());
      for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
        while (end < edges.size() && edges[end].first == edges[i].first) ++end;
        if (end - i != 2) continue;
        const std::uint32_t a = edges[i].second, b = edges[i + 1].second;
        neighbor[a / 4][a % 4] = b;
        neighbor[b / 4][b % 4] = a;
      }
    }
  });
  return neighbor;
}

class Overlay {
 public:
  /// Of a piece a corner that is farther than what is known from the triangle below.
  struct Far {
    Vec3d at{0.0};
    std::uint32_t below = 0;    ///< triangle of the surface
    std::uint32_t nearest = 0;  ///< likewise: near to it
    double distance = 0.0;      ///< from the surface, where it is farther than what is known; else 0
  };

  /// Where a triangle is cut: wherever it passes from one triangle of the surface to another, so that below() has all
  /// that it lies over, up to the limit of pieces; or not where the one is near enough to all of it.
  enum class Cuts : std::uint8_t { kAll, kNeeded };
  /// After `most_pieces` what is left of a triangle is not cut any more.
  Overlay(const LinkedSurface& surface, std::size_t most_pieces, Cuts cuts)
      : surface_(surface), most_pieces_(most_pieces), cuts_(cuts) {}

  /// Whether all of a triangle is within `known`. Else far() has corners that are beyond, and rest() what is open.
  /// `start`: a triangle of the surface near to some point of it, best to its middle. `is_raised`: by a corner that is
  /// beyond `known` is raised, and what is nearer than that is left out.
  [[nodiscard]] bool is_within(const TriangleCorners& corners, std::uint32_t start, double known,
                               bool is_raised = true);

  [[nodiscard]] std::span<const Far> far() const { return far_; }
  /// The triangles of the surface that parts of it lie over; Cuts::kNeeded: some of them.
  [[nodiscard]] std::span<const std::uint32_t> below() const { return below_; }
  struct Rest {
    TriangleCorners corners;
    std::uint32_t near = 0;
    double bound = 0.0;  ///< no point of it is farther
  };
  [[nodiscard]] std::span<const Rest> rest() const { return rest_; }

 private:
  static constexpr std::uint32_t kMostCorners = 10;
  /// Two corners side by side. The bits are those of one after the other.
  using Pair = double __attribute__((vector_size(16)));
  /// Corners by axis, so that two are looked at at once; where their number is odd, the last one again.
  struct Polygon {
    std::array<std::array<double, kMostCorners>, 3> at;  ///< [axis][corner]
    std::uint32_t count;

    [[nodiscard]] Vec3d corner(std::size_t i) const { return {at[0][i], at[1][i], at[2][i]}; }
    void add(const Vec3d& x) {
      for (int axis = 0; axis < 3; ++axis) at[static_cast<std::size_t>(axis)][count] = x[axis];
      ++count;
    }
    void fill_pair() {
      if (count % 2 == 0) return;
      for (auto& of_axis : at) of_axis[count] = of_axis[count - 1];
    }
    [[nodiscard]] Pair pair(std::size_t axis, std::size_t i) const {
      Pair two;
      std::memcpy(&two, &at[axis][2 * i], sizeof(two));
      return two;
    }
  };
  struct Piece {
    Polygon polygon;
    std::uint32_t triangle;
    std::uint32_t entered;  ///< over that edge; 3: over none
  };

  /// Triangles, in 14 kB: with 256 a build of the bunny takes 0.1% fewer instructions, and more of a cache.
  static constexpr std::size_t kHeld = 64;
  /// A triangle of the surface as pieces over it see it.
  struct Below {
    std::uint32_t triangle = kNoId;
    TriangleCorners corners;
    Vec3d to_b{0.0}, to_c{0.0}, up{0.0};  ///< weights of two corners, and the height, as functions of the place
    double longest = std::numeric_limits<double>::infinity();  ///< edge; infinity: the others are not trusted
    std::array<Vec3d, 3> outward{};  ///< across each edge, of the plane that parts it from the triangle beyond; 0: none
  };

  [[nodiscard]] const Below& below_of(std::uint32_t triangle);
  void cut(Piece& piece);
  Piece& push();
  [[nodiscard]] bool is_surely_near(const Polygon& p, const Below& below) const;
  void check(const Piece& piece);
  void leave(const Piece& piece, double bound);

  const LinkedSurface& surface_;
  std::size_t most_pieces_;
  Cuts cuts_;
  double known_ = 0.0;
  bool is_raised_ = true;
  std::deque<Piece> pieces_;   ///< as many as there ever were
  std::vector<Piece*> stack_;  ///< all of them: first those that are still to be looked at
  std::size_t size_ = 0;
  std::vector<Below> held_;  ///< by the last digits of the triangle
  std::vector<std::uint32_t> below_;
  std::vector<Far> far_;
  std::vector<Rest> rest_;
};

}  // namespace meshlode::builder
