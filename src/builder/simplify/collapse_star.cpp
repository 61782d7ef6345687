// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_star.h"

#include <algorithm>

namespace meshlode::builder {

namespace {

/// Of every two outer edges that run along each other in opposite directions the first stands for the sheet between
/// them, and both leave the star. Sorted, because a hub may have thousands.
void move_sheets_out_of_star(CollapseStar& star) {
  using OuterEdge = CollapseStar::OuterEdge;
  std::vector<OuterEdge>& outer = star.outer;
  std::stable_sort(outer.begin(), outer.end(), [](const OuterEdge& s, const OuterEdge& t) {
    const auto s_low = std::min(s.x, s.y), t_low = std::min(t.x, t.y);
    return s_low != t_low ? s_low < t_low : std::max(s.x, s.y) < std::max(t.x, t.y);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < outer.size();) {
    // Edges kept of this pair of vertices all run the same way: one the other way takes one of them off.
    const std::size_t first_kept = kept;
    const OuterEdge edge = outer[i];
    for (; i < outer.size(); ++i) {
      const OuterEdge next = outer[i];
      const bool is_along = next.x == edge.x && next.y == edge.y, is_against = next.x == edge.y && next.y == edge.x;
      if (!is_along && !is_against) break;
      if (kept > first_kept && outer[kept - 1].x == next.y) {
        star.sheets.push_back(outer[--kept]);
      } else {
        outer[kept++] = next;
      }
    }
  }
  outer.resize(kept);
}

}  // namespace

void gather_corners(CollapseMesh& mesh, std::uint32_t a, std::uint32_t b, CollapseStar& star) {
  star.a.vertex = a;
  star.b.vertex = b;
  mesh.corners_of(a, star.a.corners);
  mesh.corners_of(b, star.b.corners);
}

bool has_shared_triangle(const CollapseMesh& mesh, const CollapseStar& star) {
  return std::any_of(star.a.corners.begin(), star.a.corners.end(), [&](std::uint32_t corner) {
    const auto [x, y] = mesh.others(corner);
    return x == star.b.vertex || y == star.b.vertex;
  });
}

void gather_neighbors(const CollapseMesh& mesh, VertexMarks& marks, StarEnd& end) {
  end.neighbors.clear();
  marks.start_search();
  for (const std::uint32_t corner : end.corners) {
    for (const std::uint32_t v : mesh.others(corner)) {
      if (marks.mark(v)) end.neighbors.push_back(v);
    }
  }
}

void gather_outer_edges(const CollapseMesh& mesh, bool drops_sheets, CollapseStar& star) {
  const std::uint32_t a = star.a.vertex, b = star.b.vertex;
  star.outer.clear();
  star.sheets.clear();
  for (const StarEnd* end : {&star.a, &star.b}) {
    for (const std::uint32_t corner : end->corners) {
      const auto [x, y] = mesh.others(corner);
      if (x == a || x == b || y == a || y == b) continue;
      star.outer.push_back({x, y, corner});
    }
  }
  if (drops_sheets) move_sheets_out_of_star(star);
}

}  // namespace meshlode::builder
