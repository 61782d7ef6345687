// SPDX-License-Identifier: GPL-3.0-or-later
// What moving a vertex costs: the planes of the faces that it stands for, upright walls on held edges, and what of the
// attributes' error depends on no value.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/held_edges.h"
#include "builder/simplify/quadric.h"

namespace meshlode::builder {

/// A triangle in the group's frame.
struct Face {
  Vec3d p, e1, e2;  ///< the first corner, and the edges from it to the others
  Vec3d normal;     ///< of unit length; unset without area
  double twice_area = 0.0;
};

[[nodiscard]] inline Face face_of(const CollapseMesh& mesh, const GroupPlaces& places, std::uint32_t triangle) {
  Face face;
  face.p = places[mesh.vertex(3 * triangle)];
  face.e1 = places[mesh.vertex(3 * triangle + 1)] - face.p;
  face.e2 = places[mesh.vertex(3 * triangle + 2)] - face.p;
  face.normal = glm::cross(face.e1, face.e2);
  face.twice_area = std::sqrt(glm::dot(face.normal, face.normal));
  if (face.twice_area > 0.0) face.normal /= face.twice_area;
  return face;
}

/// `Real`, of the quadrics: double or float.
template <class Real>
class SurfaceQuadrics {
 public:
  /// `border_weight` is the weight of walls on borders against the planes of faces.
  SurfaceQuadrics(std::size_t vertex_count, double border_weight)
      : vertex_(vertex_count), wall_of_(vertex_count, kNoId), border_weight_(static_cast<Real>(border_weight)) {}

  /// `of_attributes` is what AttributeQuadrics::add_face() returned. \pre face.twice_area > 0
  void add_face(const std::array<std::uint32_t, 3>& vertices, const Face& face,
                const BasicQuadric<Real>& of_attributes = {});
  /// Walls stand upright on their triangles, and weigh with the square of the edge's length.
  void add_walls(std::span<const HeldEdge> edges, const CollapseMesh& mesh, const GroupPlaces& places);
  /// A wedge of the vertex has lost its last triangle, and its error counts no more.
  void forget(std::uint32_t vertex, const BasicQuadric<Real>& of_attributes) { vertex_[vertex].all -= of_attributes; }

  /// What the joined vertex of a and b costs; its weight is that of the faces alone.
  [[nodiscard]] BasicQuadric<Real> around(std::uint32_t a, std::uint32_t b) const {
    BasicQuadric<Real> total = vertex_[a].all;
    total += vertex_[b].all;
    return total;
  }
  /// `into` stands for what `from` stood for too. Returns the mean squared distance at its place, to planes or to
  /// borders, whichever is larger, in the frame.
  double join(std::uint32_t into, std::uint32_t from, const Vec3d& place);

  /// Area of the faces that a vertex stands for.
  [[nodiscard]] double weight(std::uint32_t vertex) const { return double{vertex_[vertex].all.weight}; }
  /// Over all vertices: three times the area.
  [[nodiscard]] double total_weight() const { return total_weight_; }

 private:
  struct OfVertex {
    BasicQuadric<Real> all;    ///< weight: of the faces alone
    BasicQuadric<Real> faces;  ///< for the error that is told
  };
  [[nodiscard]] static double mean_error2(const BasicQuadric<Real>& q, const Vec3d& place) {
    return q.weight > Real(0) ? double{q.evaluate(place)} / double{q.weight} : 0.0;
  }
  [[nodiscard]] BasicQuadric<Real>& wall_at(std::uint32_t vertex);

  std::vector<OfVertex> vertex_;
  std::vector<BasicQuadric<Real>> walls_;  ///< on borders, unweighted, for the error that is told
  std::vector<std::uint32_t> wall_of_;     ///< per vertex; kNoId: most stand on no border
  Real border_weight_;
  double total_weight_ = 0.0;
};

template <class Real>
void SurfaceQuadrics<Real>::add_face(const std::array<std::uint32_t, 3>& vertices, const Face& face,
                                     const BasicQuadric<Real>& of_attributes) {
  const double area = 0.5 * face.twice_area;
  BasicQuadric<Real> plane;
  plane.add_plane(glm::vec<3, Real>(face.normal), static_cast<Real>(-glm::dot(face.normal, face.p)),
                  static_cast<Real>(area));
  BasicQuadric<Real> all = plane;
  all += of_attributes;
  for (const std::uint32_t v : vertices) {
    vertex_[v].all += all;
    vertex_[v].faces += plane;
  }
  total_weight_ += 3.0 * area;
}

template <class Real>
BasicQuadric<Real>& SurfaceQuadrics<Real>::wall_at(std::uint32_t vertex) {
  if (wall_of_[vertex] == kNoId) {
    wall_of_[vertex] = static_cast<std::uint32_t>(walls_.size());
    walls_.emplace_back();
  }
  return walls_[wall_of_[vertex]];
}

template <class Real>
void SurfaceQuadrics<Real>::add_walls(std::span<const HeldEdge> edges, const CollapseMesh& mesh,
                                      const GroupPlaces& places) {
  for (const HeldEdge& held : edges) {
    const std::uint32_t first = 3 * held.triangle;
    const Vec3d& p = places[mesh.vertex(first)];
    const Vec3d n = glm::cross(places[mesh.vertex(first + 1)] - p, places[mesh.vertex(first + 2)] - p);
    const Vec3d edge = places[held.b] - places[held.a];
    Vec3d upright = glm::cross(n, edge);
    const double length = std::sqrt(glm::dot(upright, upright));
    if (!(length > 0.0)) continue;
    upright /= length;
    BasicQuadric<Real> wall;
    wall.add_plane(glm::vec<3, Real>(upright), static_cast<Real>(-glm::dot(upright, places[held.a])),
                   static_cast<Real>(held.weight * glm::dot(edge, edge)));
    for (const std::uint32_t v : {held.a, held.b}) {
      vertex_[v].all.add_scaled(wall, held.is_border ? border_weight_ : Real(1));
      if (held.is_border) wall_at(v) += wall;
    }
  }
}

template <class Real>
double SurfaceQuadrics<Real>::join(std::uint32_t into, std::uint32_t from, const Vec3d& place) {
  vertex_[into].all += vertex_[from].all;
  vertex_[into].faces += vertex_[from].faces;
  const double of_faces = mean_error2(vertex_[into].faces, place);
  if (wall_of_[from] != kNoId) {
    if (wall_of_[into] == kNoId) {
      wall_of_[into] = wall_of_[from];
    } else {
      walls_[wall_of_[into]] += walls_[wall_of_[from]];
    }
  }
  return wall_of_[into] == kNoId ? of_faces : std::max(of_faces, mean_error2(walls_[wall_of_[into]], place));
}

}  // namespace meshlode::builder
