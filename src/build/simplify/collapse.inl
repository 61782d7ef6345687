// SPDX-License-Identifier: GPL-3.0-or-later
// The collapses themselves, cheapest first, and what they drop.
// Definitions of GroupSimplifier, included by simplify.cpp.

namespace meshlode::build {

template <std::size_t C>
void GroupSimplifier<C>::seed_candidates() {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * mesh_.alive_count());
  for (std::uint32_t corner = 0; corner < 3 * mesh_.triangle_count(); ++corner) {
    if (!mesh_.is_alive(corner / 3)) continue;
    const std::uint32_t a = mesh_.vertex(corner);
    const std::uint32_t b = mesh_.vertex(CollapseMesh::next_in_triangle(corner));
    edges.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [a, b] : edges) push_candidate(a, b);
}

template <std::size_t C>
void GroupSimplifier<C>::push_candidate(std::uint32_t a, std::uint32_t b) {
  if (is_locked_[a] != 0 && is_locked_[b] != 0) {
    ++obstacles_[static_cast<std::size_t>(Obstacle::kLocked)];
    return;
  }
  if (a > b) std::swap(a, b);
  const Placement placement = place(a, b);
  queue_.push({placement.cost, a, b, version_[a], version_[b]});
}

template <std::size_t C>
typename GroupSimplifier<C>::Obstacle GroupSimplifier<C>::try_collapse(const Candidate& candidate) {
  std::uint32_t a = candidate.a;
  std::uint32_t b = candidate.b;
  const Placement placement = place(a, b);  // leaves the wedge classes behind
  for (std::size_t i = 0; i < class_count_; ++i) {
    if (classes_[i].is_ambiguous) return Obstacle::kSeams;
  }
  Vec3d target = placement.position;
  if (is_locked_[a] == 0 && is_locked_[b] == 0) target = to_frame(to_grid(target));
  mesh_.corners_of(a, corners_a_);
  mesh_.corners_of(b, corners_b_);
  if (is_locked_[a] != 0 && !keeps_shared_edges(a, corners_a_, corners_b_)) return Obstacle::kLocked;
  if (is_locked_[b] != 0 && !keeps_shared_edges(b, corners_b_, corners_a_)) return Obstacle::kLocked;
  if (is_locked_[a] != 0 && !keeps_shared_corners(a, corners_b_)) return Obstacle::kSeams;
  if (is_locked_[b] != 0 && !keeps_shared_corners(b, corners_a_)) return Obstacle::kSeams;
  bool breaks_topology = false;
  if (!keeps_topology(a, b)) {
    if (!options_.may_relax_topology) return Obstacle::kTopology;
    if (!candidate.may_break_topology) {
      queue_.push({kTopologyPrice * candidate.cost, a, b, version_[a], version_[b], true});
      return Obstacle::kPutBack;
    }
    breaks_topology = true;
  }
  if (!are_flips_relaxed_ && (turns_over(a, b, corners_a_, target) || turns_over(b, a, corners_b_, target))) {
    return Obstacle::kFlips;
  }
  // Thin closed features vanish almost free of plane error, and crevices and tunnels close so. What the source points
  // behind both vertices would be left at, and how far the new triangles are from the old, is the truth of it: where that
  // is far more than the quadrics say, the collapse waits for its turn at that price.
  collect_new_star(a, b, breaks_topology || has_broken_topology_);
  const double lost2 = collect_vanishing(a, b, target);
  const double left_behind2 = std::max(lost2, weigh_witnesses(a, b, target));
  const double mean_weight = 2.0 * total_weight_ / mesh_.alive_count();
  const double price_of_distance2 = kGuardShare * std::sqrt(std::max(mean_weight, plane_[a].weight + plane_[b].weight));
  double price = price_of_distance2 * left_behind2;
  if (price <= candidate.cost) {
    const double affordable2 = price_of_distance2 > 0.0 ? candidate.cost / price_of_distance2 : 0.0;
    const double reached2 = new_surface_distance2(target, affordable2);
    if (reached2 > affordable2) price = price_of_distance2 * reached2;
  }
  if (price > candidate.cost) {
    queue_.push({price, a, b, version_[a], version_[b], candidate.may_break_topology});
    return Obstacle::kPutBack;
  }
  has_broken_topology_ |= breaks_topology;
  if (is_locked_[b] != 0) std::swap(a, b);
  collapse(a, b, target);
  return Obstacle::kNone;
}

/// Joins b into a at `target`. The wedge classes of the pair are in classes_.
template <std::size_t C>
void GroupSimplifier<C>::collapse(std::uint32_t a, std::uint32_t b, const Vec3d& target) {
  plane_[a] += plane_[b];
  border_[a] += border_[b];
  if (!seam_.empty()) seam_[a] += seam_[b];
  if (plane_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(plane_[a].evaluate(target) / plane_[a].weight));
  }
  if (border_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(border_[a].evaluate(target) / border_[a].weight));
  }
  std::stable_sort(left_behind_.begin(), left_behind_.end(),
                   [](const auto& x, const auto& y) { return x.first > y.first; });
  witnesses_[a].count = static_cast<std::uint32_t>(std::min(left_behind_.size(), Witnesses::kCapacity));
  for (std::uint32_t i = 0; i < witnesses_[a].count; ++i) witnesses_[a].points[i] = left_behind_[i].second;
  merged_[a].low = glm::min(merged_[a].low, merged_[b].low);
  merged_[a].high = glm::max(merged_[a].high, merged_[b].high);
  is_border_[a] |= is_border_[b];
  if (is_locked_[a] == 0) {
    grid_position_[a] = to_grid(target);
    position_[a] = to_frame(grid_position_[a]);
  }
  const auto relabel = [&](std::uint32_t vertex, std::uint32_t from, std::uint32_t to) {
    for (const std::uint32_t corner : vertex == a ? corners_a_ : corners_b_) {
      if (mesh_.wedge(corner) == from) mesh_.set_wedge(corner, to);
    }
  };
  mesh_.corners_of(a, corners_a_);
  mesh_.corners_of(b, corners_b_);
  for (std::size_t i = 0; i < class_count_; ++i) {
    const WedgeClass& c = classes_[i];
    const std::uint32_t keeper = c.fixed != kSeveralWedges ? c.fixed : c.members[0];
    for (const std::uint32_t w : c.members) {
      if (w == keeper) continue;
      wedge_[keeper].add(wedge_[w], attribute_count_);
      relabel(a, w, keeper);
      relabel(b, w, keeper);
    }
    if (c.fixed == kSeveralWedges && wedge_[keeper].base.weight > 0.0) {
      for (std::size_t j = 0; j < attribute_count_; ++j) value_[keeper][j] = wedge_[keeper].best(j, position_[a]);
    }
  }
  mesh_.merge_vertices(a, b);
  ++version_[a];
  ++version_[b];

  if (has_broken_topology_) error_ = std::max(error_, drop_collapsed_sheets(a));
  update_wedges(a);
  mesh_.corners_of(a, corners_a_);
  if (corners_a_.empty()) error_ = std::max(error_, merged_[a].diagonal());

  neighbors_a_.clear();
  for (const std::uint32_t corner : corners_a_) {
    const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
    neighbors_a_.push_back(mesh_.vertex(next));
    neighbors_a_.push_back(mesh_.vertex(CollapseMesh::next_in_triangle(next)));
  }
  std::sort(neighbors_a_.begin(), neighbors_a_.end());
  neighbors_a_.erase(std::unique(neighbors_a_.begin(), neighbors_a_.end()), neighbors_a_.end());
  const std::vector<std::uint32_t> around = neighbors_a_;
  for (const std::uint32_t n : around) push_candidate(a, n);
}

/// Removes pairs of triangles that lie on each other. Such a sheet has no plane error, but it was there: returns its
/// smallest height, or the size of what stood behind vertices that go with it, in frame units.
template <std::size_t C>
double GroupSimplifier<C>::drop_collapsed_sheets(std::uint32_t vertex) {
  mesh_.drop_opposite_pairs(vertex, dropped_);
  double lost = 0.0;
  for (const std::uint32_t t : dropped_) {
    const std::uint32_t v[3] = {mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
    const Vec3d e0 = position_[v[1]] - position_[v[0]];
    const Vec3d e1 = position_[v[2]] - position_[v[1]];
    const Vec3d e2 = position_[v[0]] - position_[v[2]];
    const Vec3d cross = glm::cross(e0, e1);
    const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
    if (longest2 > 0.0) lost = std::max(lost, std::sqrt(glm::dot(cross, cross) / longest2));
    for (const std::uint32_t corner_vertex : v) {
      mesh_.corners_of(corner_vertex, corners_b_);
      if (corners_b_.empty()) lost = std::max(lost, merged_[corner_vertex].diagonal());
    }
  }
  return lost;
}

template <std::size_t C>
void GroupSimplifier<C>::run_passes() {
  for (int pass = 0; pass < kMaxPasses && mesh_.alive_count() > options_.target_triangles; ++pass) {
    obstacles_.fill(0);
    queue_ = {};
    seed_candidates();
    bool any = false;
    while (!queue_.empty() && mesh_.alive_count() > options_.target_triangles) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      if (version_[candidate.a] != candidate.version_a || version_[candidate.b] != candidate.version_b) continue;
      const Obstacle obstacle = try_collapse(candidate);
      if (obstacle == Obstacle::kNone) {
        any = true;
      } else {
        ++obstacles_[static_cast<std::size_t>(obstacle)];
      }
    }
    if (!any) break;  // obstacles depend on neighbours too, so what was refused is tried again as long as something moved
  }
}

template <std::size_t C>
void GroupSimplifier<C>::run() {
  run_passes();
  if (options_.may_relax_flips && mesh_.alive_count() > options_.target_triangles) {
    are_flips_relaxed_ = true;
    run_passes();
  }
  if (options_.keep_area) grow_pieces();
}

}  // namespace meshlode::build
