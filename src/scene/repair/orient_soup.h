// SPDX-License-Identifier: GPL-3.0-or-later
// A soup of triangles becomes an oriented surface: CGAL's Polygon_mesh_processing::orient_polygon_soup, behind plain
// arrays.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace meshlode::scene {

using SoupTriangle = std::array<std::uint32_t, 3>;

struct OrientedSoup {
  /// As they came in, but turned (the last two corners change places) and with copies instead of some vertices. An edge
  /// has two triangles at most, in opposite directions, and those around a vertex are one fan.
  std::vector<SoupTriangle> triangles;
  std::vector<bool> is_turned;           ///< one per triangle
  std::vector<std::uint32_t> copies_of;  ///< what vertex_count, vertex_count + 1 … are copies of
  std::uint64_t cut_edges = 0;           ///< edges that had more than two triangles
};

/// Neighbours across an edge of two triangles are made to agree; in each piece the minority is turned, of equal parts
/// the one without the first triangle. An edge of more than two triangles is cut into borders, and a piece that cannot
/// be oriented (a Möbius strip) is cut where its orientation meets itself. Of three different vertices each, below
/// vertex_count. Takes time that grows with the square of how many triangles meet in a vertex.
[[nodiscard]] OrientedSoup orient_soup(std::vector<SoupTriangle> triangles, std::uint32_t vertex_count);

}  // namespace meshlode::scene
