// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes small enough to be drawn by hand, for the parts of the simplifier.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/edge_uses.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"
#include "support/random.h"
#include "support/simplify_input.h"

namespace meshlode::test {

using builder::CollapseMesh;
using builder::CollapseStar;
using builder::GroupPlaces;
using builder::SimplifyInput;
using builder::WedgeTriangle;

/// Triangles of points of the grid. The first wedges are the points' own, of the same numbers; `more` says the points
/// of further ones.
struct DrawnMesh {
  std::vector<Vec3i> points;
  std::vector<WedgeTriangle> triangles;
  std::vector<std::uint32_t> wedge_position;
  CollapseMesh mesh;
  GroupPlaces places;
  builder::VertexMarks marks;

  DrawnMesh(std::vector<Vec3i> at, std::vector<WedgeTriangle> of, const std::vector<std::uint32_t>& more = {})
      : points(std::move(at)),
        triangles(std::move(of)),
        wedge_position(own_wedges(points.size(), more)),
        mesh(triangles, wedge_position, points.size()),
        places(points),
        marks(points.size()) {
    mesh.number_edges(builder::sorted_edge_uses(mesh));
  }

  /// With its facets around the middle of the edge, or around `target`.
  [[nodiscard]] CollapseStar star(std::uint32_t a, std::uint32_t b, bool drops_sheets = false) {
    return star_at((places[a] + places[b]) * 0.5, a, b, drops_sheets);
  }
  [[nodiscard]] CollapseStar star_at(const Vec3d& target, std::uint32_t a, std::uint32_t b, bool drops_sheets = false) {
    CollapseStar star;
    mesh.gather(a, star.a);
    mesh.gather(b, star.b);
    (void)builder::gather_star(mesh, marks, star);
    if (drops_sheets) builder::move_sheets_out(star);
    star.target = target;
    builder::gather_facets(mesh, places, star);
    return star;
  }
  /// b becomes a, where a is.
  void join(std::uint32_t a, std::uint32_t b) {
    const CollapseStar joined = star(a, b);
    mesh.join(joined.a, joined.b, joined.gone(), joined.on_edge, false);
  }

  static std::vector<std::uint32_t> own_wedges(std::size_t count, const std::vector<std::uint32_t>& more) {
    std::vector<std::uint32_t> own(count);
    std::iota(own.begin(), own.end(), 0U);
    own.insert(own.end(), more.begin(), more.end());
    return own;
  }
};

/// What a squared distance of floats may be off by, in the frame, for stars as large as it: a dozen roundings of
/// numbers of up to 1.
constexpr double kFloats = 1e-6;

/// A squared distance in the frame, from one in grid units.
inline double in_frame(const DrawnMesh& drawn, double distance2) {
  return distance2 / (drawn.places.scale() * drawn.places.scale());
}

/// Coordinates from 0 to below `size`.
inline Vec3i random_point(RandomSource& random, std::uint32_t size) {
  const auto coordinate = [&] { return static_cast<std::int32_t>(random.below(size)); };
  const std::int32_t x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

inline SimplifyInput as_input(const DrawnMesh& drawn) {
  return as_input(drawn.points, drawn.wedge_position, drawn.triangles);
}

/// The flat star of the edge (0, 1), all of its triangles counterclockwise; its border are 2 … 9:
///
///        5 ---- 4 ---- 3
///       / \    / \    / \        y = 4
///      6 -- 0 ----- 1 -- 2       y = 0
///       \ /    \ /    \ /
///        7 ---- 8 ---- 9         y = -4
inline const std::vector<Vec3i> kFanPoints{{0, 0, 0},  {4, 0, 0},  {8, 0, 0},   {6, 4, 0},  {2, 4, 0},
                                           {-2, 4, 0}, {-4, 0, 0}, {-2, -4, 0}, {2, -4, 0}, {6, -4, 0}};
inline const std::vector<WedgeTriangle> kUpperFan{{1, 2, 3}, {1, 3, 4}, {1, 4, 0}, {0, 4, 5}, {0, 5, 6}};
inline const std::vector<WedgeTriangle> kLowerFan{{0, 6, 7}, {0, 7, 8}, {0, 8, 1}, {1, 8, 9}, {1, 9, 2}};

inline DrawnMesh closed_fan() {
  std::vector<WedgeTriangle> all = kUpperFan;
  all.insert(all.end(), kLowerFan.begin(), kLowerFan.end());
  return {kFanPoints, all};
}
/// The upper half alone: 6, 0, 1 and 2 lie on its border.
inline DrawnMesh open_fan() {
  return {kFanPoints, kUpperFan};
}

/// The closed fan with a seam along 6, 0, 1, 2: below it the wedges are 13, 10, 11 and 12.
inline DrawnMesh seamed_fan() {
  std::vector<WedgeTriangle> all = kUpperFan;
  for (WedgeTriangle t : kLowerFan) {
    for (std::uint32_t& w : t) w = w == 0 ? 10 : w == 1 ? 11 : w == 2 ? 12 : w == 6 ? 13 : w;
    all.push_back(t);
  }
  return {kFanPoints, all, {0, 1, 2, 6}};
}

/// Closed: the smallest thing that the link condition keeps.
inline DrawnMesh tetrahedron() {
  return {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
}

}  // namespace meshlode::test
