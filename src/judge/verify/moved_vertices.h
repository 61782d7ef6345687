// SPDX-License-Identifier: GPL-3.0-or-later
// Where the source's vertices are on the grid: each at the point nearest to it, but for those that the writer moved by
// one point so that a needle keeps its width. Which did is not stored; docs/reference/format.md ("Grid points", section
// 17) says which it has to be, as a function of the level-0 triangles alone.
//
// Nothing is believed because of that rule: it gives one point for each exact position, and V101 then asks whether the
// source on those points is level 0, triangle by triangle. To look for such points in level 0 itself would be to solve
// a puzzle: where a grid collapses hundreds of triangles into one cell, what is left of them fits many places.
#pragma once

#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "judge/metrics/triangle_corners.h"
#include "judge/verify/triangle_key.h"

namespace meshlode::judge {

class MovedVertices {
 public:
  MovedVertices() = default;
  MovedVertices(const Vec3d& origin, double step) : origin_(origin), step_(step) {}

  /// Finds the vertices that the rule moves. `triangles` are the corners, in the source, of those in level 0; their
  /// order does not matter. O(n log n).
  void find(const TriangleCorners& triangles);

  /// The vertex's point on the grid. A source that is not the asset's may lie anywhere; such a corner matches nothing.
  [[nodiscard]] GridPoint point_of(const Vec3d& position) const;
  [[nodiscard]] bool empty() const { return moved_.empty(); }

 private:
  using Place = std::tuple<double, double, double>;  ///< relative to the origin

  [[nodiscard]] Vec3d relative(const Vec3d& position) const { return position + 0.0 - origin_; }
  [[nodiscard]] GridPoint nearest(const Vec3d& relative) const;
  [[nodiscard]] GridPoint point_at(const Vec3d& relative) const;
  [[nodiscard]] static std::size_t slot_of(const GridPoint& point);
  /// Points beside the needles that a vertex of the triangles is nearest to, ascending.
  [[nodiscard]] std::vector<GridPoint> points_beside(const TriangleCorners& triangles,
                                                     const std::vector<std::pair<Place, Place>>& needles) const;

  Vec3d origin_{0.0};
  double step_ = 1.0;
  std::map<Place, GridPoint> moved_;
  std::vector<std::uint8_t> moved_from_;  ///< by slot_of() a point: whether any was moved from one of that slot
};

}  // namespace meshlode::judge
