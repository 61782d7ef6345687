// SPDX-License-Identifier: GPL-3.0-or-later
// What it costs to move a group's surface: planes of its faces, and walls on the edges that are held in place.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

[[nodiscard]] Face face_of(const CollapseMesh& mesh, const GroupPlaces& places, std::uint32_t triangle);

/// Per vertex, the quadrics of the faces and of the held edges that it stands for. `Real`: double or float.
template <class Real>
class SurfaceQuadrics {
 public:
  /// `border_weight` is the weight of walls on borders against the planes of faces.
  SurfaceQuadrics(std::size_t vertex_count, double border_weight);

  /// \pre face.twice_area > 0
  void add_face(const std::array<std::uint32_t, 3>& vertices, const Face& face);
  /// Walls stand upright on their triangles, and weigh with the square of the edge's length.
  void add_walls(std::span<const HeldEdge> edges, const CollapseMesh& mesh, const GroupPlaces& places);

  /// What the joined vertex of a and b costs; its weight is that of the faces alone.
  [[nodiscard]] BasicQuadric<Real> around(std::uint32_t a, std::uint32_t b) const {
    BasicQuadric<Real> total = plane_[a];
    total += plane_[b];
    if ((has_wall_[a] | has_wall_[b]) != 0) add_walls_around(a, b, total);
    return total;
  }
  /// `into` stands for what `from` stood for too. Returns the root of the mean squared distance at its place, to planes
  /// or to borders, whichever is larger, in the frame.
  double join(std::uint32_t into, std::uint32_t from, const Vec3d& place);

  /// Area of the faces that a vertex stands for.
  [[nodiscard]] double weight(std::uint32_t vertex) const { return double{plane_[vertex].weight}; }
  /// Over all vertices: three times the area.
  [[nodiscard]] double total_weight() const { return total_weight_; }

 private:
  void add_walls_around(std::uint32_t a, std::uint32_t b, BasicQuadric<Real>& total) const {
    const auto weight = static_cast<Real>(border_weight_);
    total.add_scaled(border_[a], weight);
    total.add_scaled(border_[b], weight);
    if (seam_.empty()) return;
    total.add_scaled(seam_[a], Real(1));
    total.add_scaled(seam_[b], Real(1));
  }

  std::vector<BasicQuadric<Real>> plane_, border_, seam_;  ///< seam_ is empty where there is none
  std::vector<std::uint8_t> has_wall_;                     ///< per vertex: most stand on no border and no seam
  double border_weight_;
  double total_weight_ = 0.0;
};

}  // namespace meshlode::builder
