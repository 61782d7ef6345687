// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/surface_quadrics.h"

namespace meshlode::builder {

Face face_of(const CollapseMesh& mesh, const GroupPlaces& places, std::uint32_t triangle) {
  Face face;
  face.p = places[mesh.vertex(3 * triangle)];
  face.e1 = places[mesh.vertex(3 * triangle + 1)] - face.p;
  face.e2 = places[mesh.vertex(3 * triangle + 2)] - face.p;
  const Vec3d cross = glm::cross(face.e1, face.e2);
  face.twice_area = std::sqrt(glm::dot(cross, cross));
  if (face.twice_area > 0.0) face.normal = cross / face.twice_area;
  return face;
}

template <class Real>
SurfaceQuadrics<Real>::SurfaceQuadrics(std::size_t vertex_count, double border_weight)
    : plane_(vertex_count), border_(vertex_count), has_wall_(vertex_count, 0), border_weight_(border_weight) {}

template <class Real>
void SurfaceQuadrics<Real>::add_face(const std::array<std::uint32_t, 3>& vertices, const Face& face) {
  const double area = 0.5 * face.twice_area;
  const glm::vec<3, Real> normal(face.normal);
  const auto offset = static_cast<Real>(-glm::dot(face.normal, face.p));
  BasicQuadric<Real> plane;
  plane.add_plane(normal, offset, static_cast<Real>(area));
  for (const std::uint32_t v : vertices) plane_[v] += plane;
  total_weight_ += 3.0 * area;
}

template <class Real>
void SurfaceQuadrics<Real>::add_walls(std::span<const HeldEdge> edges, const CollapseMesh& mesh,
                                      const GroupPlaces& places) {
  for (const HeldEdge& held : edges) {
    if (!held.is_border && seam_.empty()) seam_.resize(plane_.size());
    const std::uint32_t first = 3 * held.triangle;
    const Vec3d& p = places[mesh.vertex(first)];
    const Vec3d n = glm::cross(places[mesh.vertex(first + 1)] - p, places[mesh.vertex(first + 2)] - p);
    const Vec3d edge = places[held.b] - places[held.a];
    Vec3d wall = glm::cross(n, edge);
    const double length = std::sqrt(glm::dot(wall, wall));
    if (!(length > 0.0)) continue;
    wall /= length;
    const auto d = static_cast<Real>(-glm::dot(wall, places[held.a]));
    const auto weight = static_cast<Real>(held.weight * glm::dot(edge, edge));
    std::vector<BasicQuadric<Real>>& quadrics = held.is_border ? border_ : seam_;
    has_wall_[held.a] = has_wall_[held.b] = 1;
    quadrics[held.a].add_plane(glm::vec<3, Real>(wall), d, weight);
    quadrics[held.b].add_plane(glm::vec<3, Real>(wall), d, weight);
  }
}

template <class Real>
double SurfaceQuadrics<Real>::join(std::uint32_t into, std::uint32_t from, const Vec3d& place) {
  plane_[into] += plane_[from];
  if (has_wall_[from] != 0) {
    border_[into] += border_[from];
    if (!seam_.empty()) seam_[into] += seam_[from];
    has_wall_[into] = 1;
  }
  double error = 0.0;
  for (const BasicQuadric<Real>* q : {&plane_[into], &border_[into]}) {
    if (q->weight > Real(0)) error = std::max(error, std::sqrt(double{q->evaluate(place)} / double{q->weight}));
  }
  return error;
}

template class SurfaceQuadrics<double>;
template class SurfaceQuadrics<float>;

}  // namespace meshlode::builder
