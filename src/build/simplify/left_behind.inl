// SPDX-License-Identifier: GPL-3.0-or-later
// How far a collapse leaves the old surface from the new and the new from the old, beyond what quadrics say.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

/// The triangles that would surround the joined vertex, by their outer edges. Where sheets are dropped, pairs that would
/// lie on each other do not count: they will be gone.
template <std::size_t C>
void GroupSimplifier<C>::collect_new_star(std::uint32_t a, std::uint32_t b, bool drops_sheets) {
  star_.clear();
  sheet_.clear();
  for (const auto* corners : {&corners_a_, &corners_b_}) {
    for (const std::uint32_t corner : *corners) {
      const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
      const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(corner)));
      if (x == a || x == b || y == a || y == b) continue;
      star_.push_back({x, y, corner});
    }
  }
  if (drops_sheets) move_sheets_out_of_star();
}

/// Of every two outer edges that run along each other in opposite directions the first stands for the sheet between them,
/// and both leave the star. Sorted, because a hub may have thousands.
template <std::size_t C>
void GroupSimplifier<C>::move_sheets_out_of_star() {
  std::stable_sort(star_.begin(), star_.end(), [](const OuterEdge& s, const OuterEdge& t) {
    const auto s_low = std::min(s.x, s.y), t_low = std::min(t.x, t.y);
    return s_low != t_low ? s_low < t_low : std::max(s.x, s.y) < std::max(t.x, t.y);
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < star_.size();) {
    // Edges kept of this pair of vertices all run the same way: one the other way takes one of them off.
    const std::size_t first_kept = kept;
    const OuterEdge edge = star_[i];
    for (; i < star_.size(); ++i) {
      const OuterEdge next = star_[i];
      const bool is_along = next.x == edge.x && next.y == edge.y, is_against = next.x == edge.y && next.y == edge.x;
      if (!is_along && !is_against) break;
      if (kept > first_kept && star_[kept - 1].x == next.y) {
        sheet_.push_back(star_[--kept]);
      } else {
        star_[kept++] = next;
      }
    }
  }
  star_.resize(kept);
}

/// What goes without a vertex noticing: an edge to a neighbour that no triangle covers any more, a dropped sheet, and
/// neighbours whose triangles all go (their witnesses are weighed too). Returns the largest squared distance at which
/// such points are left, taken to the middle of what goes.
template <std::size_t C>
double GroupSimplifier<C>::collect_vanishing(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  vanishing_.clear();
  double lost2 = 0.0;
  const std::uint64_t stamp = ++stamp_;  // of vertices that stay in the star, or have been looked at
  for (const OuterEdge& edge : star_) vertex_stamp_[edge.x] = vertex_stamp_[edge.y] = stamp;
  for (const auto* corners : {&corners_a_, &corners_b_}) {
    for (const std::uint32_t corner : *corners) {
      const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
      for (const std::uint32_t v : {mesh_.vertex(next), mesh_.vertex(CollapseMesh::next_in_triangle(next))}) {
        if (v == a || v == b || vertex_stamp_[v] == stamp) continue;
        vertex_stamp_[v] = stamp;
        mesh_.corners_of(v, dropped_);
        const bool has_others = std::any_of(dropped_.begin(), dropped_.end(), [&](std::uint32_t c) {
          const std::uint32_t x = mesh_.vertex(CollapseMesh::next_in_triangle(c));
          const std::uint32_t y = mesh_.vertex(CollapseMesh::next_in_triangle(CollapseMesh::next_in_triangle(c)));
          return x != a && x != b && y != a && y != b;
        });
        const Vec3d uncovered = position_[v] - target;
        lost2 = std::max(lost2, (has_others ? 0.25 : 1.0) * glm::dot(uncovered, uncovered));
        if (!has_others) vanishing_.push_back(v);
      }
    }
  }
  for (const OuterEdge& edge : sheet_) {
    const Vec3d base = position_[edge.y] - position_[edge.x];
    const Vec3d cross = glm::cross(base, target - position_[edge.x]);
    const double base2 = glm::dot(base, base);
    if (base2 > 0.0) lost2 = std::max(lost2, 0.25 * glm::dot(cross, cross) / base2);
  }
  return lost2;
}

/// The largest squared distance from what is left behind to the group's triangles away from both vertices.
template <std::size_t C>
double GroupSimplifier<C>::distance2_to_rest(std::uint32_t a, std::uint32_t b) const {
  double largest = 0.0;
  for (const auto& [unused, point] : left_behind_) {
    const Vec3d p = to_frame(point);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (!mesh_.is_alive(t)) continue;
      const std::array<std::uint32_t, 3> v{mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
      if (std::any_of(v.begin(), v.end(), [&](std::uint32_t x) { return x == a || x == b; })) continue;
      nearest = std::min(nearest, distance2_to_facet(p, position_[v[0]], position_[v[1]], position_[v[2]]));
    }
    largest = std::max(largest, nearest);
  }
  return largest;
}

/// The largest squared distance from the witnesses of both vertices to the new star; left_behind_ holds all of them.
template <std::size_t C>
double GroupSimplifier<C>::weigh_witnesses(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  left_behind_.clear();
  double largest = 0.0;
  const auto weigh = [&](std::uint32_t vertex) {
    const Witnesses& w = witnesses_[vertex];
    for (std::uint32_t i = 0; i < w.count; ++i) {
      const Vec3d point = to_frame(w.points[i]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const OuterEdge& edge : star_) {
        nearest = std::min(nearest, distance2_to_facet(point, target, position_[edge.x], position_[edge.y]));
      }
      left_behind_.emplace_back(nearest, w.points[i]);
      largest = std::max(largest, nearest);
    }
  };
  weigh(a);
  weigh(b);
  for (const std::uint32_t v : vanishing_) weigh(v);
  if (!star_.empty()) return largest;
  // The piece vanishes. Of foliage its size is what is lost: its neighbours grow instead. Else what it leaves is as far
  // off as the nearest of what stays.
  const Box both{glm::min(merged_[a].low, merged_[b].low), glm::max(merged_[a].high, merged_[b].high)};
  if (options_.keep_area) return both.diagonal() * both.diagonal();
  return std::min(distance2_to_rest(a, b), 1e30);
}

/// How far the new star is from the triangles that it replaces, squared, where that exceeds `least`; else `least`. By the
/// middles of its triangles and of their edges at the target.
template <std::size_t C>
double GroupSimplifier<C>::new_surface_distance2(const Vec3d& target, double least) const {
  double farthest = least;
  const auto reach = [&](const Vec3d& point, std::uint32_t likely) {
    double nearest = std::numeric_limits<double>::infinity();
    // True where the triangle is so near that the point does not count.
    const auto is_near = [&](std::uint32_t corner) {
      const std::uint32_t t = corner / 3;
      nearest = std::min(nearest, distance2_to_facet(point, position_[mesh_.vertex(3 * t)],
                                                     position_[mesh_.vertex(3 * t + 1)], position_[mesh_.vertex(3 * t + 2)]));
      return nearest <= farthest;
    };
    if (is_near(likely)) return;
    for (const auto* corners : {&corners_a_, &corners_b_}) {
      if (std::any_of(corners->begin(), corners->end(), is_near)) return;
    }
    if (nearest < std::numeric_limits<double>::infinity()) farthest = nearest;
  };
  for (const OuterEdge& edge : star_) {  // what a triangle is replaced by is mostly near it
    reach((target + position_[edge.x] + position_[edge.y]) / 3.0, edge.corner);
    reach((target + position_[edge.x]) * 0.5, edge.corner);
    reach((target + position_[edge.y]) * 0.5, edge.corner);
  }
  return farthest;
}

}  // namespace meshlode::build
