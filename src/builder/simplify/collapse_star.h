// SPDX-License-Identifier: GPL-3.0-or-later
// The star of a collapse: the triangles around both ends of an edge, gathered once for all that weighs the collapse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "builder/simplify/collapse_mesh.h"

namespace meshlode::builder {

/// A vertex and what is around it.
struct StarEnd {
  std::uint32_t vertex = 0;
  std::vector<std::uint32_t> corners;    ///< the living ones at the vertex: gather_corners
  std::vector<std::uint32_t> neighbors;  ///< each once, as its corners come: gather_neighbors
};

/// Which vertices have been met in a search; a new search forgets them all at once.
class VertexMarks {
 public:
  explicit VertexMarks(std::size_t vertex_count) : search_(vertex_count, 0) {}
  void start_search() { ++now_; }
  [[nodiscard]] bool is_marked(std::uint32_t vertex) const { return search_[vertex] == now_; }
  /// False where it was marked before.
  bool mark(std::uint32_t vertex) {
    if (is_marked(vertex)) return false;
    search_[vertex] = now_;
    return true;
  }

 private:
  std::vector<std::uint64_t> search_;  ///< that met each vertex last
  std::uint64_t now_ = 0;
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

/// Whether a triangle has both ends. \pre the corners are gathered
[[nodiscard]] bool has_shared_triangle(const CollapseMesh& mesh, const CollapseStar& star);

/// They alone are marked then. \pre the corners are gathered
void gather_neighbors(const CollapseMesh& mesh, VertexMarks& marks, StarEnd& end);

/// The triangles on the edge itself go and have no outer edge. Where sheets are dropped, pairs of triangles that would
/// lie on each other in opposite orientation do not count: they will be gone. \pre the corners are gathered
void gather_outer_edges(const CollapseMesh& mesh, bool drops_sheets, CollapseStar& star);

}  // namespace meshlode::builder
