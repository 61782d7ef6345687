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
  if (locks_.is_vertex_locked[a] != 0 && locks_.is_vertex_locked[b] != 0) {
    ++obstacles_[static_cast<std::size_t>(Obstacle::kLocked)];
    return;
  }
  if (a > b) std::swap(a, b);
  star_.a.vertex = a;
  star_.b.vertex = b;
  if (classes_.needs_corners(a, b)) gather_corners(mesh_, a, b, star_);
  const Placement placement = place(a, b);
  queue_.push({placement.cost, a, b, version_[a], version_[b]});
}

template <std::size_t C>
typename GroupSimplifier<C>::Obstacle GroupSimplifier<C>::try_collapse(const Candidate& candidate) {
  std::uint32_t a = candidate.a;
  std::uint32_t b = candidate.b;
  gather_corners(mesh_, a, b, star_);
  const Placement placement = place(a, b);  // leaves the wedge classes behind
  for (const WedgeClass& joined : classes_.classes()) {
    if (!agree(joined)) return Obstacle::kSeams;
  }
  star_.target = placement.position;
  const bool is_free = locks_.is_vertex_locked[a] == 0 && locks_.is_vertex_locked[b] == 0;
  if (is_free) star_.target = places_.to_frame(places_.to_grid(star_.target));
  if (!keeps_shared_edges(mesh_, locks_, star_)) return Obstacle::kLocked;
  if (attribute_count_ > 0 && !keeps_shared_corners(mesh_, locks_, classes_, star_)) return Obstacle::kSeams;
  bool breaks_topology = false;
  if (!keeps_topology(mesh_, is_border_, star_)) {
    if (!options_.may_relax_topology) return Obstacle::kTopology;
    if (!candidate.may_break_topology) {
      queue_.push({kTopologyPrice * candidate.cost, a, b, version_[a], version_[b], true});
      return Obstacle::kPutBack;
    }
    breaks_topology = true;
  }
  if (!are_flips_relaxed_ && turns_over(mesh_, places_, star_)) return Obstacle::kFlips;
  gather_outer_edges(mesh_, breaks_topology || has_broken_topology_, star_);
  const double price = price_of(candidate);
  if (price > candidate.cost) {
    queue_.push({price, a, b, version_[a], version_[b], candidate.may_break_topology});
    return Obstacle::kPutBack;
  }
  has_broken_topology_ |= breaks_topology;
  if (locks_.is_vertex_locked[b] != 0) std::swap(a, b);
  collapse(a, b);
  return Obstacle::kNone;
}

/// What leaving the old surface behind, or reaching beyond it, costs: where that is far more than the quadrics say, the
/// collapse waits for its turn at that price.
template <std::size_t C>
double GroupSimplifier<C>::price_of(const Candidate& candidate) {
  const double left_behind2 = left_behind_.weigh(mesh_, places_, star_, options_.keep_area);
  const double mean_weight = 2.0 * total_weight_ / mesh_.alive_count();
  const double weight = plane_[candidate.a].weight + plane_[candidate.b].weight;
  const double price_of_distance2 = kGuardShare * std::sqrt(std::max(mean_weight, weight));
  const double price = price_of_distance2 * left_behind2;
  if (price > candidate.cost) return price;
  const double affordable2 = price_of_distance2 > 0.0 ? candidate.cost / price_of_distance2 : 0.0;
  const double reached2 = new_surface_distance2(mesh_, places_, star_, affordable2);
  return reached2 > affordable2 ? price_of_distance2 * reached2 : price;
}

/// Joins b into a at the star's target. The star and the wedge classes are those of the pair.
template <std::size_t C>
void GroupSimplifier<C>::collapse(std::uint32_t a, std::uint32_t b) {
  plane_[a] += plane_[b];
  border_[a] += border_[b];
  if (!seam_.empty()) seam_[a] += seam_[b];
  if (plane_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(plane_[a].evaluate(star_.target) / plane_[a].weight));
  }
  if (border_[a].weight > 0.0) {
    error_ = std::max(error_, std::sqrt(border_[a].evaluate(star_.target) / border_[a].weight));
  }
  left_behind_.join(a, b);
  is_border_[a] |= is_border_[b];
  if (locks_.is_vertex_locked[a] == 0) places_.move(a, star_.target);
  for (const WedgeClass& c : classes_.classes()) {
    const std::uint32_t keeper = c.keeper();
    for (const std::uint32_t w : c.members) {
      if (w != keeper) wedge_[keeper].add(wedge_[w], attribute_count_);
    }
    relabel_wedges(mesh_, star_, c);
    if (c.fixed == WedgeClass::kNone && wedge_[keeper].base.weight > 0.0) {
      for (std::size_t j = 0; j < attribute_count_; ++j) value_[keeper][j] = wedge_[keeper].best(j, places_[a]);
    }
  }
  mesh_.merge_vertices(a, b);
  ++version_[a];
  ++version_[b];

  if (has_broken_topology_) error_ = std::max(error_, drop_collapsed_sheets(a));
  joined_.vertex = a;
  mesh_.corners_of(a, joined_.corners);
  classes_.update(mesh_, joined_);
  if (joined_.corners.empty()) error_ = std::max(error_, left_behind_.size(a));
  gather_neighbors(mesh_, joined_);
  for (const std::uint32_t n : joined_.neighbors) push_candidate(a, n);
}

/// Removes pairs of triangles that lie on each other. Such a sheet has no plane error, but it was there: returns its
/// smallest height, or the size of what stood behind vertices that go with it, in frame units.
template <std::size_t C>
double GroupSimplifier<C>::drop_collapsed_sheets(std::uint32_t vertex) {
  std::vector<std::uint32_t> dropped, corners;
  mesh_.drop_opposite_pairs(vertex, dropped);
  double lost = 0.0;
  for (const std::uint32_t t : dropped) {
    const std::uint32_t v[3] = {mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)};
    const Vec3d e0 = places_[v[1]] - places_[v[0]];
    const Vec3d e1 = places_[v[2]] - places_[v[1]];
    const Vec3d e2 = places_[v[0]] - places_[v[2]];
    const Vec3d cross = glm::cross(e0, e1);
    const double longest2 = std::max({glm::dot(e0, e0), glm::dot(e1, e1), glm::dot(e2, e2)});
    if (longest2 > 0.0) lost = std::max(lost, std::sqrt(glm::dot(cross, cross) / longest2));
    for (const std::uint32_t corner_vertex : v) {
      mesh_.corners_of(corner_vertex, corners);
      if (corners.empty()) lost = std::max(lost, left_behind_.size(corner_vertex));
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
