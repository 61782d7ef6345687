// SPDX-License-Identifier: GPL-3.0-or-later
// Where the source's vertices went on the grid: each to the point nearest to it, or, where two corners of a narrow
// triangle would have met in one, to the next point along an axis that is no farther than half a cell's diagonal. Which
// did is not stored; it is found here from the triangles that are missing at the nearest points.
#pragma once

#include <array>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "base/vec.h"
#include "verify/triangle_key.h"

namespace meshlode {

struct MissingTriangle {
  std::uint32_t material = 0;
  std::array<Vec3d, 3> corner;  ///< of the source
};

class MovedVertices {
 public:
  MovedVertices() = default;
  MovedVertices(const Vec3d& origin, double step) : origin_(origin), step_(step) {}

  /// Finds the moves that take `missing` to triangles among `unmatched` (sorted). Only corners that share their nearest
  /// point with another corner of a missing triangle may have moved. A vertex has one place: a move that one triangle
  /// leaves no choice about binds the others at that vertex.
  void find(std::span<const MissingTriangle> missing, std::span<const TriangleKey> unmatched);

  /// The vertex's point on the grid. A source that is not the asset's may lie anywhere; such a corner matches nothing.
  [[nodiscard]] GridPoint point_of(const Vec3d& position) const;
  [[nodiscard]] bool empty() const { return moved_.empty(); }

 private:
  [[nodiscard]] GridPoint nearest(const Vec3d& position) const;
  [[nodiscard]] std::vector<GridPoint> choices(const Vec3d& position) const;

  Vec3d origin_{0.0};
  double step_ = 1.0;
  std::set<std::tuple<double, double, double>> may_move_;
  std::map<std::tuple<double, double, double>, GridPoint> moved_;
};

}  // namespace meshlode
