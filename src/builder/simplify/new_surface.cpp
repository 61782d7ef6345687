// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/new_surface.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace meshlode::builder {

namespace {

/// Whether the middle of the edge to `outer[i].y` is asked about with another triangle, that begins there.
bool begins_another(const std::vector<CollapseStar::OuterEdge>& outer, std::size_t i) {
  constexpr std::size_t kFew = 32;  // at a hub the search would cost more than asking twice
  if (outer.size() > kFew) return false;
  for (std::size_t k = 0; k < outer.size(); ++k) {
    if (outer[k].x == outer[i].y) return true;
  }
  return false;
}

}  // namespace

void NewSurface::gather_replaced(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star) {
  const auto add = [&](std::uint32_t corner) {
    const std::uint32_t t = corner / 3;
    replaced_.add(places[mesh.vertex(3 * t)], places[mesh.vertex(3 * t + 1)], places[mesh.vertex(3 * t + 2)]);
  };
  replaced_.start(star.target);
  for (const CollapseStar::OuterEdge& edge : star.outer) add(edge.corner);
  // What has no outer edge: triangles on the edge itself, and sheets that are dropped (then all come twice).
  for (const std::uint32_t corner : star.a.corners) {
    const auto [x, y] = mesh.others(corner);
    if (x == star.b.vertex || y == star.b.vertex || !star.sheets.empty()) add(corner);
  }
  if (!star.sheets.empty()) {
    for (const std::uint32_t corner : star.b.corners) add(corner);
  }
  replaced_.finish();
}

// The largest over the points of the least over the triangles: neither order nor repetition changes it, so that a point
// is asked about once, and of the triangles first the one that the new one replaces, which is mostly near.
double NewSurface::distance2(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                             double least) {
  gather_replaced(mesh, places, star);
  double farthest = least;
  auto enough = static_cast<float>(least);
  const auto reach = [&](const Vec3d& point) {
    const float nearest = replaced_.distance2_to(point, enough);
    if (nearest <= enough) return;
    farthest = std::max(farthest, double{nearest});
    enough = nearest;
  };
  middles_.clear();
  spokes_.clear();
  for (const CollapseStar::OuterEdge& edge : star.outer) {
    middles_.push_back((star.target + places[edge.x] + places[edge.y]) / 3.0);
    spokes_.push_back((star.target + places[edge.x]) * 0.5);
  }
  for (const std::vector<Vec3d>* points : {&middles_, &spokes_}) {
    replaced_.distances2_one_by_one(*points, by_triangle_);
    for (std::size_t i = 0; i < points->size(); ++i) {
      if (!(by_triangle_[i] <= enough)) reach((*points)[i]);
    }
  }
  for (std::size_t i = 0; i < star.outer.size(); ++i) {
    if (!begins_another(star.outer, i)) reach((star.target + places[star.outer[i].y]) * 0.5);
  }
  return farthest;
}

}  // namespace meshlode::builder
