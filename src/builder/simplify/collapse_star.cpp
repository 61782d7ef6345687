// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/collapse_star.h"

#include <algorithm>

namespace meshlode::builder {

namespace {

void add_outer(CollapseStar& star, std::uint32_t x, std::uint32_t y, std::uint32_t corner) {
  star.outer_edges[star.outer_count++] = {x, y, corner};
}

/// The triangles at a: their vertices are marked, and those on the edge are told apart.
bool gather_first(const CollapseMesh& mesh, VertexMarks& marks, CollapseStar& star) {
  for (const std::uint32_t corner : star.a.corners()) {
    const auto [x, y] = mesh.others(corner);
    marks.mark(x);
    marks.mark(y);
    if (x != star.b.vertex && y != star.b.vertex) {
      add_outer(star, x, y, corner);
      continue;
    }
    if (star.on_edge == CollapseStar::kMostOnEdge) return false;
    star.tips[star.on_edge++] = x == star.b.vertex ? y : x;
    star.gone_triangles[star.gone_count++] = corner / 3;
  }
  marks.unmark(star.b.vertex);
  return true;
}

/// The triangles at b: what is marked is a neighbour of both.
void gather_second(const CollapseMesh& mesh, VertexMarks& marks, CollapseStar& star) {
  const auto meet = [&](std::uint32_t v) {
    if (!marks.is_marked_once(v)) return;
    marks.mark_twice(v);
    ++star.common_neighbors;
  };
  for (const std::uint32_t corner : star.b.corners()) {
    const auto [x, y] = mesh.others(corner);
    if (x != star.a.vertex) meet(x);
    if (y != star.a.vertex) meet(y);
    if (x != star.a.vertex && y != star.a.vertex) add_outer(star, x, y, corner);
  }
}

bool has_tip_edge(std::span<const CollapseStar::OuterEdge> outer, const VertexMarks& marks) {
  return std::any_of(outer.begin(), outer.end(), [&](const CollapseStar::OuterEdge& edge) {
    return marks.is_marked_twice(edge.x) && marks.is_marked_twice(edge.y);
  });
}

void set_facet(std::span<FourFacets> blocks, std::size_t i, const Vec3d& corner, const Vec3d& to_b, const Vec3d& to_c) {
  blocks[i / 4].triangles.set(i % 4, Vec3f(corner), Vec3f(to_b), Vec3f(to_c));
}

/// The last triangle fills its block, which changes no minimum.
void finish_facets(std::span<FourFacets> blocks, std::size_t count) {
  if (count == 0) return;
  FourTriangles& last = blocks[(count - 1) / 4].triangles;
  for (std::size_t k = (count - 1) % 4; k < 3; ++k) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      last.a[axis][k + 1] = last.a[axis][k];
      last.ab[axis][k + 1] = last.ab[axis][k];
      last.ac[axis][k + 1] = last.ac[axis][k];
    }
  }
  for (std::size_t i = 0; 4 * i < count; ++i) blocks[i].terms = terms_of(blocks[i].triangles);
}

}  // namespace

Gathered gather_star(const CollapseMesh& mesh, VertexMarks& marks, CollapseStar& star) {
  star.outer_count = star.gone_count = star.on_edge = star.common_neighbors = 0;
  marks.start_search();
  if (!gather_first(mesh, marks, star)) return Gathered::kTooMany;
  const std::uint32_t at_a = star.outer_count;
  gather_second(mesh, marks, star);
  star.has_tip_edges = star.common_neighbors >= 2 && has_tip_edge(star.outer().first(at_a), marks) &&
                       has_tip_edge(star.outer().subspan(at_a), marks);
  return star.on_edge == 0 ? Gathered::kNoTriangle : Gathered::kStar;
}

void move_sheets_out(CollapseStar& star) {
  std::array<bool, CollapseStar::kMostOuter> is_sheet{};
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < star.outer_count; ++i) {
    if (is_sheet[i]) continue;
    const CollapseStar::OuterEdge edge = star.outer_edges[i];
    std::uint32_t k = i + 1;
    const auto is_against = [&] { return star.outer_edges[k].x == edge.y && star.outer_edges[k].y == edge.x; };
    while (k < star.outer_count && (is_sheet[k] || !is_against())) ++k;
    if (k == star.outer_count) {
      star.outer_edges[kept++] = edge;
      continue;
    }
    is_sheet[k] = true;
    star.gone_triangles[star.gone_count++] = edge.corner / 3;
    star.gone_triangles[star.gone_count++] = star.outer_edges[k].corner / 3;
  }
  star.outer_count = kept;
}

void gather_facets(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star) {
  std::size_t i = 0;
  const Vec3d at_a = places[star.a.vertex] - star.target, at_b = places[star.b.vertex] - star.target;
  for (const CollapseStar::OuterEdge& edge : star.outer()) {
    const Vec3d x = places[edge.x] - star.target, y = places[edge.y] - star.target;
    const bool is_at_a = mesh.vertex(edge.corner) == star.a.vertex;
    const Vec3d& apex = is_at_a ? at_a : at_b;
    set_facet(star.fresh, i, Vec3d(0.0), x, y);
    set_facet(star.old, i, apex, x - apex, y - apex);
    ++i;
  }
  finish_facets(star.fresh, i);
  finish_facets(star.old, i);
}

std::size_t add_gone(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star) {
  const std::span<FourFacets> blocks = std::span(star.old).subspan(star.block_count());
  std::size_t i = 0;
  for (const std::uint32_t t : star.gone()) {
    const Vec3d &p = places[mesh.vertex(3 * t)], &q = places[mesh.vertex(3 * t + 1)],
                &r = places[mesh.vertex(3 * t + 2)];
    set_facet(blocks, i++, p - star.target, q - p, r - p);
  }
  finish_facets(blocks, i);
  return star.block_count() + (i + 3) / 4;
}

}  // namespace meshlode::builder
