// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of this room that sees CGAL. What is taken of it is combinatorial, without a coordinate: its headers
// alone, and none of its flags.
#include "scene/repair/orient_soup.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>

#include "base/disjoint_sets.h"

namespace meshlode::scene {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;

/// Copied by CGAL, so that it points to what it collects. Called once for each triangle of the edge.
struct CutEdges : pmp::Default_orientation_visitor {
  explicit CutEdges(std::vector<std::pair<std::size_t, std::size_t>>& seen) : edges(&seen) {}
  void non_manifold_edge(std::size_t a, std::size_t b, std::size_t) const {
    edges->emplace_back(std::min(a, b), std::max(a, b));
  }
  std::vector<std::pair<std::size_t, std::size_t>>* edges;
};

/// CGAL goes by the first triangle of each piece, which may be the only one that is wrong: pieces of which more than
/// half was turned are turned back whole. Triangles that share a vertex are of one piece, because each vertex has one
/// fan.
void let_majority_decide(OrientedSoup& soup, std::size_t vertex_count) {
  DisjointSets pieces(vertex_count);
  for (const SoupTriangle& t : soup.triangles) {
    pieces.join(t[0], t[1]);
    pieces.join(t[0], t[2]);
  }
  std::vector<std::uint64_t> size(vertex_count, 0), turned(vertex_count, 0);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const std::uint32_t piece = pieces.find(soup.triangles[i][0]);
    ++size[piece];
    turned[piece] += soup.is_turned[i] ? 1U : 0U;
  }
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const std::uint32_t piece = pieces.find(soup.triangles[i][0]);
    if (2 * turned[piece] <= size[piece]) continue;
    std::swap(soup.triangles[i][1], soup.triangles[i][2]);
    soup.is_turned[i] = !soup.is_turned[i];
  }
}

}  // namespace

OrientedSoup orient_soup(std::vector<SoupTriangle> triangles, std::uint32_t vertex_count) {
  // The points are their own numbers: CGAL only copies them, and so says which vertex a new one is a copy of.
  std::vector<std::uint32_t> points(vertex_count);
  std::iota(points.begin(), points.end(), 0U);
  std::vector<std::pair<std::size_t, std::size_t>> edges;
  OrientedSoup out;
  out.triangles = triangles;
  pmp::orient_polygon_soup(points, out.triangles, CGAL::parameters::visitor(CutEdges(edges)));

  std::sort(edges.begin(), edges.end());
  out.cut_edges = static_cast<std::uint64_t>(std::unique(edges.begin(), edges.end()) - edges.begin());
  out.copies_of.assign(points.begin() + vertex_count, points.end());
  out.is_turned.resize(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    SoupTriangle& t = out.triangles[i];
    // CGAL reverses the corners; corner 0 is to stay the first.
    out.is_turned[i] = points[t[0]] != triangles[i][0];
    if (out.is_turned[i]) t = {t[2], t[0], t[1]};
  }
  let_majority_decide(out, points.size());
  return out;
}

}  // namespace meshlode::scene
