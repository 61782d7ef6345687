// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/left_behind.h"

#include <algorithm>
#include <array>
#include <limits>

#include "builder/simplify/point_triangle.h"

namespace meshlode::builder {

namespace {

/// Equals stay in order. Mostly there are half a dozen, and std::stable_sort would allocate.
void sort_farthest_first(std::vector<WeighedWitness>& weighed) {
  constexpr std::size_t kFew = 32;
  if (weighed.size() > kFew) {
    std::stable_sort(weighed.begin(), weighed.end(),
                     [](const auto& x, const auto& y) { return x.distance2 > y.distance2; });
    return;
  }
  for (std::size_t i = 1; i < weighed.size(); ++i) {
    const WeighedWitness one = weighed[i];
    std::size_t at = i;
    for (; at > 0 && weighed[at - 1].distance2 < one.distance2; --at) weighed[at] = weighed[at - 1];
    weighed[at] = one;
  }
}

}  // namespace

LeftBehind::LeftBehind(std::vector<Witnesses> witnesses, const GroupPlaces& places)
    : witnesses_(std::move(witnesses)), merged_(places.size()), vertex_stamp_(places.size(), 0) {
  for (std::uint32_t v = 0; v < places.size(); ++v) merged_[v] = {places[v], places[v]};
}

/// What goes without a vertex noticing: an edge to a neighbour that no triangle covers any more, a dropped sheet, and
/// neighbours whose triangles all go (their witnesses are weighed too). Returns the largest squared distance at which
/// such points are left, taken to the middle of what goes.
double LeftBehind::collect_vanishing(CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star) {
  const std::uint32_t a = star.a.vertex, b = star.b.vertex;
  vanishing_.clear();
  double lost2 = 0.0;
  const std::uint64_t stamp = ++stamp_;  // of vertices that stay in the star, or have been looked at
  for (const CollapseStar::OuterEdge& edge : star.outer) vertex_stamp_[edge.x] = vertex_stamp_[edge.y] = stamp;
  for (const StarEnd* end : {&star.a, &star.b}) {
    for (const std::uint32_t corner : end->corners) {
      for (const std::uint32_t v : mesh.others(corner)) {
        if (v == a || v == b || vertex_stamp_[v] == stamp) continue;
        vertex_stamp_[v] = stamp;
        mesh.corners_of(v, corners_);
        const bool has_others = std::any_of(corners_.begin(), corners_.end(), [&](std::uint32_t c) {
          const auto [x, y] = mesh.others(c);
          return x != a && x != b && y != a && y != b;
        });
        const Vec3d uncovered = places[v] - star.target;
        lost2 = std::max(lost2, (has_others ? 0.25 : 1.0) * glm::dot(uncovered, uncovered));
        if (!has_others) vanishing_.push_back(v);
      }
    }
  }
  for (const CollapseStar::OuterEdge& edge : star.sheets) {
    const Vec3d base = places[edge.y] - places[edge.x];
    const Vec3d cross = glm::cross(base, star.target - places[edge.x]);
    const double base2 = glm::dot(base, base);
    if (base2 > 0.0) lost2 = std::max(lost2, 0.25 * glm::dot(cross, cross) / base2);
  }
  return lost2;
}

void LeftBehind::gather_facets(const GroupPlaces& places, const CollapseStar& star) {
  facets_.start(star.target);
  for (const CollapseStar::OuterEdge& edge : star.outer) facets_.add(star.target, places[edge.x], places[edge.y]);
  facets_.finish();
}

/// The largest squared distance from the vertex's witnesses to the new star.
double LeftBehind::weigh_witnesses(std::uint32_t vertex, const GroupPlaces& places) {
  const Witnesses& w = witnesses_[vertex];
  double largest = 0.0;
  for (std::uint32_t i = 0; i < w.count; ++i) {
    const double nearest{facets_.distance2_to(places.to_frame(w.points[i]))};
    weighed_.push_back({nearest, w.points[i], w.ids[i]});
    largest = std::max(largest, nearest);
  }
  return largest;
}

/// The largest squared distance from what is left behind to the group's triangles away from both vertices, or `least`
/// if that is larger. What is no farther than the largest so far is not looked for any closer, and what is near the
/// star comes first: of thousands of loose pieces each would look at all others else.
double LeftBehind::distance2_to_rest(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                     double least) const {
  double largest = least;
  std::uint32_t middle = star.a.corners.empty() ? 0 : star.a.corners.front() / 3;
  for (const WeighedWitness& witness : weighed_) {
    const Vec3d p = places.to_frame(witness.point);
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t at = middle;
    const auto look_at = [&](std::uint32_t t) {
      if (!mesh.is_alive(t)) return;
      const std::array<std::uint32_t, 3> v{mesh.vertex(3 * t), mesh.vertex(3 * t + 1), mesh.vertex(3 * t + 2)};
      const auto is_end = [&](std::uint32_t x) { return x == star.a.vertex || x == star.b.vertex; };
      if (std::any_of(v.begin(), v.end(), is_end)) return;
      const double distance2 = distance2_to_facet(p, places[v[0]], places[v[1]], places[v[2]]);
      if (!(distance2 < nearest)) return;
      nearest = distance2;
      at = t;
    };
    const std::uint32_t first = middle;
    const auto count = static_cast<std::uint32_t>(mesh.triangle_count());
    for (std::uint32_t step = 0; (step <= first || first + step < count) && !(nearest <= largest); ++step) {
      if (step <= first) look_at(first - step);
      if (step > 0 && first + step < count) look_at(first + step);
    }
    middle = at;  // the next is not far off
    largest = std::max(largest, nearest);
  }
  return largest;
}

double LeftBehind::weigh(CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star, bool keep_area) {
  const double lost2 = collect_vanishing(mesh, places, star);
  weighed_.clear();
  gather_facets(places, star);
  double largest = weigh_witnesses(star.a.vertex, places);
  largest = std::max(largest, weigh_witnesses(star.b.vertex, places));
  for (const std::uint32_t v : vanishing_) largest = std::max(largest, weigh_witnesses(v, places));
  if (!star.outer.empty()) return std::max(lost2, largest);
  // The piece vanishes. Of foliage its size is what is lost: its neighbours grow instead. Else what it leaves is as far
  // off as the nearest of what stays.
  if (keep_area) {
    const Box& at_a = merged_[star.a.vertex];
    const Box& at_b = merged_[star.b.vertex];
    const Box both{glm::min(at_a.low, at_b.low), glm::max(at_a.high, at_b.high)};
    return std::max(lost2, both.diagonal() * both.diagonal());
  }
  return std::max(lost2, std::min(distance2_to_rest(mesh, places, star, lost2), 1e30));
}

void LeftBehind::join(std::uint32_t into, std::uint32_t from) {
  sort_farthest_first(weighed_);
  Witnesses& kept = witnesses_[into];
  kept.count = static_cast<std::uint32_t>(std::min(weighed_.size(), Witnesses::kCapacity));
  for (std::uint32_t i = 0; i < kept.count; ++i) {
    kept.points[i] = weighed_[i].point;
    kept.ids[i] = weighed_[i].id;
  }
  merged_[into].low = glm::min(merged_[into].low, merged_[from].low);
  merged_[into].high = glm::max(merged_[into].high, merged_[from].high);
}

double LeftBehind::drop_sheets(CollapseMesh& mesh, const GroupPlaces& places, std::uint32_t vertex) const {
  std::vector<std::uint32_t> dropped, corners;
  mesh.drop_opposite_pairs(vertex, dropped);
  double lost = 0.0;
  for (const std::uint32_t t : dropped) {
    const std::array<std::uint32_t, 3> v{mesh.vertex(3 * t), mesh.vertex(3 * t + 1), mesh.vertex(3 * t + 2)};
    const Vec3d e0 = places[v[1]] - places[v[0]];
    const Vec3d e1 = places[v[2]] - places[v[1]];
    const Vec3d e2 = places[v[0]] - places[v[2]];
    const Vec3d cross = glm::cross(e0, e1);
    const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
    if (longest2 > 0.0) lost = std::max(lost, std::sqrt(glm::dot(cross, cross) / longest2));
    for (const std::uint32_t corner_vertex : v) {
      mesh.corners_of(corner_vertex, corners);
      if (corners.empty()) lost = std::max(lost, size(corner_vertex));
    }
  }
  return lost;
}

}  // namespace meshlode::builder
