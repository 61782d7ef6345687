// SPDX-License-Identifier: GPL-3.0-or-later
// What a collapse costs by the quadrics of surface and attributes, where its vertex goes, and what the joined vertex
// stands for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/ids.h"
#include "builder/simplify/attribute_quadrics.h"
#include "builder/simplify/attribute_scales.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/placement.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/surface_quadrics.h"
#include "builder/simplify/wedge_classes.h"

namespace meshlode::builder {

/// How numbers are taken in every build that ships; studies instantiate others (careless.cpp).
struct CarefulNumbers {
  using Real = double;                        ///< that quadrics are summed and solved in
  static constexpr bool kHasFallback = true;  ///< of minima that cannot be trusted: see place_vertex()
};

/// For at most Capacity attributes.
template <class Numbers, std::size_t Capacity>
class CollapseCosts {
 public:
  using Real = typename Numbers::Real;
  using Attributes = AttributeQuadrics<Real, Capacity>;

  struct Weighed {
    double cost = 0.0;
    Vec3d place{0.0};
  };

  /// All must outlive this; mesh and places change with the collapses.
  CollapseCosts(const SimplifyInput& input, const SimplifyOptions& options, CollapseMesh& mesh,
                const GroupPlaces& places, const GroupLocks& locks);
  void add_walls(std::span<const HeldEdge> edges) { surface_.add_walls(edges, mesh_, places_); }

  [[nodiscard]] Weighed weigh(const CollapseMesh::Ends& ends);
  /// The cost with the vertex at `place`, instead of the best place.
  [[nodiscard]] double weigh_at(const CollapseMesh::Ends& ends, const Vec3d& place);
  /// Of the star's collapse. \pre neither end is a hub
  void collect_classes(const CollapseStar& star);
  /// Of the star collected last.
  [[nodiscard]] const WedgeClasses& classes() const { return classes_; }
  /// The quadrics and wedges of b become a's. Returns the squared error there: a mean, in the frame.
  double join(const CollapseStar& star);
  /// What no triangle has any more is forgotten. \pre the mesh is joined
  void update(const CollapseStar& star);

  [[nodiscard]] bool has_attributes() const { return attributes_.count() > 0; }
  [[nodiscard]] bool has_seams() const { return has_attributes() && only_wedge_.has_seams(); }
  [[nodiscard]] const Attributes& attributes() const { return attributes_; }
  [[nodiscard]] const SurfaceQuadrics<Real>& surface() const { return surface_; }

 private:
  /// Of an edge at a hub, that is not weighed: it is refused when it comes up.
  static constexpr double kHubCost = 1e30;

  void add_faces();
  [[nodiscard]] std::optional<double> add_attributes(const CollapseMesh::Ends& ends, const Vec3d& given,
                                                     BasicQuadric<Real>& total);

  CollapseMesh& mesh_;
  const GroupPlaces& places_;
  const GroupLocks& locks_;
  OnlyWedges only_wedge_;
  SurfaceQuadrics<Real> surface_;
  Attributes attributes_;
  WedgeClasses classes_;
  Ring ring_a_, ring_b_;  ///< of the edge weighed last, where it was looked at
};

template <class Numbers, std::size_t C>
CollapseCosts<Numbers, C>::CollapseCosts(const SimplifyInput& input, const SimplifyOptions& options, CollapseMesh& mesh,
                                         const GroupPlaces& places, const GroupLocks& locks)
    : mesh_(mesh),
      places_(places),
      locks_(locks),
      only_wedge_(mesh),
      surface_(input.positions.size(), options.border_weight),
      attributes_(input, attribute_scales(input, options, mesh, places), only_wedge_.has_seams()) {
  add_faces();
}

template <class Numbers, std::size_t C>
void CollapseCosts<Numbers, C>::add_faces() {
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Face face = face_of(mesh_, places_, t);
    if (!(face.twice_area > 0.0)) continue;
    BasicQuadric<Real> of_attributes;
    if (has_attributes()) {
      of_attributes = attributes_.add_face({mesh_.wedge(3 * t), mesh_.wedge(3 * t + 1), mesh_.wedge(3 * t + 2)}, face);
    }
    surface_.add_face({mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)}, face, of_attributes);
  }
}

template <class Numbers, std::size_t C>
typename CollapseCosts<Numbers, C>::Weighed CollapseCosts<Numbers, C>::weigh(const CollapseMesh::Ends& ends) {
  const Vec3d &pa = places_[ends[0]], &pb = places_[ends[1]];
  const bool is_a_given = locks_.is_vertex_locked[ends[0]] != 0, is_b_given = locks_.is_vertex_locked[ends[1]] != 0;
  Weighed out{kHubCost, is_a_given ? pa : pb};
  BasicQuadric<Real> total = surface_.around(ends[0], ends[1]);
  const std::optional<double> fixed_error = add_attributes(ends, out.place, total);
  if (!fixed_error) return out;
  if (!is_a_given && !is_b_given) out.place = place_vertex(total, pa, pb, Numbers::kHasFallback);
  const Vec3d along = pb - pa;
  out.cost = cost_of_collapse(total, out.place, *fixed_error, glm::dot(along, along));
  return out;
}

template <class Numbers, std::size_t C>
double CollapseCosts<Numbers, C>::weigh_at(const CollapseMesh::Ends& ends, const Vec3d& place) {
  const Vec3d &pa = places_[ends[0]], &pb = places_[ends[1]];
  BasicQuadric<Real> total = surface_.around(ends[0], ends[1]);
  const std::optional<double> fixed_error = add_attributes(ends, place, total);
  const Vec3d along = pb - pa;
  return fixed_error ? cost_of_collapse(total, place, *fixed_error, glm::dot(along, along)) : kHubCost;
}

/// The error of fixed values, or none at a hub.
template <class Numbers, std::size_t C>
std::optional<double> CollapseCosts<Numbers, C>::add_attributes(const CollapseMesh::Ends& ends, const Vec3d& given,
                                                                BasicQuadric<Real>& total) {
  if (!has_attributes()) return 0.0;
  const std::uint32_t x = only_wedge_[ends[0]], y = only_wedge_[ends[1]];
  if (x != kNoId && y != kNoId) return attributes_.add_pair(total, x, y, locks_, given);
  mesh_.gather(ends[0], ring_a_);
  mesh_.gather(ends[1], ring_b_);
  if (ring_a_.is_hub || ring_b_.is_hub) return std::nullopt;
  classes_.collect(mesh_, locks_, ring_a_, ring_b_);
  return attributes_.add_classes(total, classes_, given);
}

template <class Numbers, std::size_t C>
void CollapseCosts<Numbers, C>::collect_classes(const CollapseStar& star) {
  if (!has_attributes()) return;
  const std::uint32_t x = only_wedge_[star.a.vertex], y = only_wedge_[star.b.vertex];
  if (x != kNoId && y != kNoId) {
    classes_.set_pair(locks_, x, y);
  } else {
    classes_.collect(mesh_, locks_, star.a, star.b);
  }
}

template <class Numbers, std::size_t C>
double CollapseCosts<Numbers, C>::join(const CollapseStar& star) {
  if (has_attributes()) {
    attributes_.join(classes_);
    relabel_wedges(mesh_, star.a, classes_);
    relabel_wedges(mesh_, star.b, classes_);
  }
  return surface_.join(star.a.vertex, star.b.vertex, star.target);
}

template <class Numbers, std::size_t C>
void CollapseCosts<Numbers, C>::update(const CollapseStar& star) {
  if (!has_seams()) return;
  only_wedge_.update(mesh_, star.a.vertex);
  for (const std::uint32_t t : star.gone()) {
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t v = mesh_.vertex(corner) == star.b.vertex ? star.a.vertex : mesh_.vertex(corner);
      const std::uint32_t w = mesh_.wedge(corner);
      if (only_wedge_[v] == w) continue;
      const bool is_lost = !mesh_.any_corner(v, [&](std::uint32_t c) { return mesh_.wedge(c) == w; });
      if (is_lost) surface_.forget(v, attributes_.take_base(w));
    }
  }
}

}  // namespace meshlode::builder
