// SPDX-License-Identifier: GPL-3.0-or-later
// The largest over the points of the least over the triangles: neither order nor repetition changes it, so that a point
// is asked about once, and of the triangles first the one that the new one replaces, which is mostly near.
#include "builder/simplify/new_surface.h"

#include <algorithm>
#include <span>

namespace meshlode::builder {

namespace {

class Reach {
 public:
  Reach(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star, float enough)
      : mesh_(mesh), places_(places), star_(star), farthest2_(enough) {}

  /// Four points, each first against the old triangle in its place.
  void look_at(std::size_t block, const Vec3Lanes& points) {
    const FourFacets& old = star_.old[block];
    const LaneMask is_far = distances2_to(old.triangles, old.terms, points) > lanes(farthest2_);
    if (!any_lane(is_far)) return;
    for (std::size_t k = 0; k < 4 && 4 * block + k < star_.outer_count; ++k) {
      if (is_far[k] != 0) look_at(Vec3f(points.x[k], points.y[k], points.z[k]));
    }
  }
  void look_at(const Vec3f& point) {
    if (old_count_ == 0) old_count_ = add_gone(mesh_, places_, star_);
    farthest2_ = std::max(farthest2_, distance2_to(std::span(star_.old).first(old_count_), point));
  }
  [[nodiscard]] float farthest2() const { return farthest2_; }

 private:
  const CollapseMesh& mesh_;
  const GroupPlaces& places_;
  CollapseStar& star_;
  float farthest2_;
  std::size_t old_count_ = 0;  ///< 0: what goes has not been asked for
};

/// Whether the middle of the edge to `edge.y` is looked at with another triangle, that begins there.
bool begins_another(const CollapseStar& star, const CollapseStar::OuterEdge& edge) {
  return std::any_of(star.outer().begin(), star.outer().end(),
                     [&](const CollapseStar::OuterEdge& other) { return other.x == edge.y; });
}

Vec3Lanes middle_of(const Vec3Lanes& x, const Vec3Lanes& y) {
  const Lanes third = lanes(1.0F / 3.0F);
  return {(x.x + y.x) * third, (x.y + y.y) * third, (x.z + y.z) * third};
}
Vec3Lanes half_of(const Vec3Lanes& x) {
  const Lanes half = lanes(0.5F);
  return {x.x * half, x.y * half, x.z * half};
}

}  // namespace

MESHLODE_CLONED_FOR_AVX2
float new_surface_distance2(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star, float enough) {
  Reach reach(mesh, places, star, enough);
  for (std::size_t i = 0; i < star.block_count(); ++i) {
    const Vec3Lanes x = load3(star.fresh[i].triangles.ab), y = load3(star.fresh[i].triangles.ac);
    reach.look_at(i, middle_of(x, y));
    reach.look_at(i, half_of(x));
  }
  for (const CollapseStar::OuterEdge& edge : star.outer()) {
    if (!begins_another(star, edge)) reach.look_at(Vec3f((places[edge.y] - star.target) * 0.5));
  }
  return reach.farthest2();
}

}  // namespace meshlode::builder
