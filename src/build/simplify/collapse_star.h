// SPDX-License-Identifier: GPL-3.0-or-later
// The star of a collapse: the triangles around both ends of an edge, gathered once for all that weighs the collapse.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "build/simplify/collapse_mesh.h"

namespace meshlode::build {

/// A vertex and what is around it.
struct StarEnd {
  std::uint32_t vertex = 0;
  std::vector<std::uint32_t> corners;    ///< the living ones at the vertex: gather_corners
  std::vector<std::uint32_t> neighbors;  ///< each once, ascending: gather_neighbors
};

/// The star of the edge (a, b), whose ends would become one vertex at `target`. Filled in steps, because a collapse
/// that is refused early needs no more.
struct CollapseStar {
  /// What a triangle around the joined vertex has beside it.
  struct OuterEdge {
    std::uint32_t x, y;    ///< in the triangle's order
    std::uint32_t corner;  ///< of the triangle as it is, at a or b
  };
  StarEnd a, b;
  Vec3d target{0.0};              ///< in the group's frame
  std::vector<OuterEdge> outer;   ///< of the triangles that will be around the joined vertex: gather_outer_edges
  std::vector<OuterEdge> sheets;  ///< one for each pair of triangles that will lie on each other and be dropped
};

/// The corners at both ends, which are named here.
void gather_corners(CollapseMesh& mesh, std::uint32_t a, std::uint32_t b, CollapseStar& star);

/// \pre the corners are gathered
void gather_neighbors(const CollapseMesh& mesh, StarEnd& end);

/// The triangles on the edge itself go and have no outer edge. Where sheets are dropped, pairs of triangles that would
/// lie on each other in opposite orientation do not count: they will be gone. \pre the corners are gathered
void gather_outer_edges(const CollapseMesh& mesh, bool drops_sheets, CollapseStar& star);

}  // namespace meshlode::build
