// SPDX-License-Identifier: GPL-3.0-or-later
// The one file of this room that sees CGAL. Its exact predicates want -frounding-math, hence a target of its own;
// without GMP they fall back on Boost's whole numbers.
#define CGAL_DISABLE_GMP 1
#include "scene/import/polygons/triangulate_polygon.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_face_base_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "base/ids.h"

namespace meshlode::scene {

namespace {

/// What a face of the triangulation is to the polygon.
struct FaceInfo {
  bool is_known = false, is_inside = false;
  std::array<std::uint32_t, 3> corners{kNoId, kNoId, kNoId};
};

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<FaceInfo, Kernel>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Cdt = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                                       CGAL::No_constraint_intersection_requiring_constructions_tag>;
using Point = Kernel::Point_2;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge undirected(const Edge& edge) {
  return std::minmax(edge.first, edge.second);
}

class Triangulator {
 public:
  explicit Triangulator(std::span<const std::array<double, 2>> points) : points_(points) {}

  PolygonTriangles run() {
    number_points();
    insert_points();
    insert_sides();
    if (cdt_.dimension() < 2) return {};
    find_pieces();
    find_inside();
    PolygonTriangles out;
    out.is_simple = faces_outward();
    assign_corners();
    for (const auto& face : cdt_.finite_face_handles()) {
      if (!face->info().is_inside) continue;
      auto t = face->info().corners;
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      out.triangles.push_back(t);
    }
    std::sort(out.triangles.begin(), out.triangles.end());
    return out;
  }

 private:
  /// Equal points get one number, in the order of their coordinates.
  void number_points() {
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a] < points_[b]; });
    number_.resize(points_.size());
    for (const std::uint32_t corner : order) {
      if (first_corner_.empty() || points_[first_corner_.back()] != points_[corner]) {
        first_corner_.push_back(corner);
        corner_count_.push_back(0);
      }
      number_[corner] = static_cast<std::uint32_t>(first_corner_.size() - 1);
      ++corner_count_.back();
    }
  }

  /// In an order that looks random, for which the work grows little faster than their number.
  void insert_points() {
    std::vector<std::uint32_t> order(first_corner_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::uint64_t state = 88172645463325252U;
    for (std::size_t i = order.size(); i > 1; --i) {
      state ^= state << 13U;
      state ^= state >> 7U;
      state ^= state << 17U;
      std::swap(order[i - 1], order[state % i]);
    }
    vertices_.resize(order.size());
    Cdt::Face_handle near;
    for (const std::uint32_t number : order) {
      const auto& [x, y] = points_[first_corner_[number]];
      vertices_[number] = cdt_.insert(Point(x, y), near);
      vertices_[number]->info() = number;
      near = vertices_[number]->face();
    }
    cdt_.infinite_vertex()->info() = kNoId;
  }

  [[nodiscard]] Edge side(std::size_t corner) const {
    return {number_[corner], number_[corner + 1 == number_.size() ? 0 : corner + 1]};
  }

  void insert_sides() {
    std::vector<Edge> sides;
    for (std::size_t i = 0; i < number_.size(); ++i) {
      if (side(i).first != side(i).second) sides.push_back(undirected(side(i)));
    }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    for (const auto& [a, b] : sides) cdt_.insert_constraint(vertices_[a], vertices_[b]);
  }

  /// Sides that other corners lie on are several edges: each is walked. An edge that is passed twice is a bridge.
  void find_pieces() {
    for (std::size_t i = 0; i < number_.size(); ++i) {
      const auto [from, to] = side(i);
      for (std::uint32_t at = from; at != to;) {
        Cdt::Vertex_handle next;
        Piece piece;
        if (!cdt_.includes_edge(vertices_[at], vertices_[to], next, piece.right, piece.index)) break;
        piece.edge = {at, next->info()};
        ++passes_[undirected(piece.edge)];
        if (at == from) corner_of_.try_emplace(piece.edge, static_cast<std::uint32_t>(i));
        pieces_.push_back(piece);
        at = next->info();
      }
    }
  }

  [[nodiscard]] bool is_border(const Edge& edge) const {
    const auto found = passes_.find(undirected(edge));
    return found != passes_.end() && found->second % 2 == 1;
  }

  /// From outside in, the other side of each border edge.
  void find_inside() {
    std::vector<Cdt::Face_handle> open{cdt_.infinite_face()};
    open.back()->info().is_known = true;
    while (!open.empty()) {
      const Cdt::Face_handle face = open.back();
      open.pop_back();
      for (int i = 0; i < 3; ++i) {
        const Cdt::Face_handle next = face->neighbor(i);
        if (next->info().is_known) continue;
        const bool crosses = cdt_.is_constrained({face, i}) &&
                             is_border({face->vertex(Cdt::cw(i))->info(), face->vertex(Cdt::ccw(i))->info()});
        next->info().is_known = true;
        next->info().is_inside = face->info().is_inside != crosses;
        open.push_back(next);
      }
    }
  }

  /// The inside is to the left of every border edge, as the polygon has it.
  [[nodiscard]] bool faces_outward() const {
    return std::none_of(pieces_.begin(), pieces_.end(),
                        [&](const Piece& piece) { return piece.right->info().is_inside && is_border(piece.edge); });
  }

  /// Where corners share a point, a triangle belongs to the one whose side is the next to its right.
  void assign_corners() {
    for (std::uint32_t number = 0; number < vertices_.size(); ++number) {
      const Cdt::Vertex_handle vertex = vertices_[number];
      std::uint32_t corner = first_corner_[number];
      const Cdt::Face_circulator first = cdt_.incident_faces(vertex);
      // The second round begins with the corner that the first ended with.
      for (int round = corner_count_[number] > 1 ? 0 : 1; round < 2; ++round) {
        Cdt::Face_circulator face = first;
        do {
          const int i = face->index(vertex);
          const auto found = corner_of_.find(Edge{number, face->vertex(Cdt::ccw(i))->info()});
          if (found != corner_of_.end()) corner = found->second;
          face->info().corners[static_cast<std::size_t>(i)] = corner;
        } while (++face != first);
      }
    }
  }

  /// A part of a side, between two corners next to each other on it.
  struct Piece {
    Edge edge;
    Cdt::Face_handle right;
    int index = 0;
  };

  std::span<const std::array<double, 2>> points_;
  std::vector<std::uint32_t> number_;        ///< of each corner's point
  std::vector<std::uint32_t> first_corner_;  ///< of each number
  std::vector<std::uint32_t> corner_count_;
  std::vector<Cdt::Vertex_handle> vertices_;
  std::vector<Piece> pieces_;
  std::map<Edge, std::uint32_t> passes_;     ///< how often the polygon passes an edge, in either direction
  std::map<Edge, std::uint32_t> corner_of_;  ///< the first corner whose side begins with the edge
  Cdt cdt_;
};

}  // namespace

PolygonTriangles triangulate_polygon(std::span<const std::array<double, 2>> points) {
  if (points.size() < 3 || points.size() > kMaxTriangulatedCorners) return {};
  try {
    return Triangulator(points).run();
  } catch (const Cdt::Intersection_of_constraints_exception&) {
    return {};
  }
}

}  // namespace meshlode::scene
