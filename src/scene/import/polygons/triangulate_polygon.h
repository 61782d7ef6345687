// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons that no fan covers: dented, cut open around holes. CGAL's constrained Delaunay triangulation behind plain
// arrays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::scene {

/// Above this many corners there are none: the time grows with the square of them in the worst case.
constexpr std::size_t kMaxTriangulatedCorners = 16384;

struct PolygonTriangles {
  /// Corners of the polygon, counter-clockwise, no area twice; sorted. Empty where sides of the polygon cross each
  /// other at places that are no corner, and where it has no inside.
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// False where the border turns against itself at a corner: the even-odd rule then says what is inside.
  bool is_simple = true;
};

/// \param points of a counter-clockwise polygon, finite. Points may be equal: a side that is there in both directions
/// is a bridge to a hole, and each of its ends is the corner whose side the triangle lies on. Exact: no triangle is
/// turned over. The shape alone decides where the diagonals are, not the numbering.
[[nodiscard]] PolygonTriangles triangulate_polygon(std::span<const std::array<double, 2>> points);

}  // namespace meshlode::scene
