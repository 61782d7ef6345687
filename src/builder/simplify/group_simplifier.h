// SPDX-License-Identifier: GPL-3.0-or-later
// The simplifier's loop: the cheapest edge is tried; its star is gathered, its guards are asked, and it is collapsed or
// put back at its price. What a collapse costs, what may not be collapsed and what is left behind are types and
// functions of their own, each in its file.
//
// Order of collapses: E / √W, E the area-weighted quadric error at the new place and W the summed area. It beats E
// because E grows with the area behind a vertex, not only with how far the surface moves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/ids.h"
#include "builder/simplify/collapse_costs.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/edge_heap.h"
#include "builder/simplify/edge_uses.h"
#include "builder/simplify/gap_guard.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/guards.h"
#include "builder/simplify/held_edges.h"
#include "builder/simplify/kept_topology.h"
#include "builder/simplify/left_behind.h"
#include "builder/simplify/new_surface.h"
#include "builder/simplify/obstacles.h"
#include "builder/simplify/painted_guard.h"
#include "builder/simplify/pieces.h"
#include "builder/simplify/refused_edges.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/write_group.h"

namespace meshlode::builder {

/// For at most Capacity attributes.
template <class Numbers, std::size_t Capacity>
class GroupSimplifier {
 public:
  /// Both must outlive this.
  GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options);
  void run();
  [[nodiscard]] SimplifyResult result() const;
  /// Whether an edge of the border has an end that may move. Without one the border's image is the border.
  [[nodiscard]] bool has_free_border() const { return has_free_border_; }

 private:
  using Real = typename Numbers::Real;

  static constexpr int kMaxPasses = 8;
  /// A collapse costs at least this share of what its largest displacement, of the old surface from the new or of the
  /// new from the old, would cost as a mean distance.
  static constexpr double kGuardShare = 0.7;
  /// So many times that for what is painted, where that is promised: its largest distance alone then orders collapses
  /// that move it. (With 1 cuts that keep a promise need more triangles, with 64 no fewer.)
  static constexpr double kPaintedFactor = 16.0;
  /// So many times what a distance costs, for what goes too far into a gap after all (gap_guard.cpp).
  static constexpr double kGapFactor = 64.0;
  /// What breaking the link condition costs, as a factor: small holes and handles close when everything else has become
  /// about ten times as far off.
  static constexpr double kTopologyPrice = 10.0;

  /// What the edge was weighed at.
  struct Candidate {
    std::uint32_t versions = 0;  ///< of its ends: they only grow, so that their sum is the same where neither has
    bool may_break_topology = false;
    bool keeps_gaps = false;  ///< its place and its price are those of keep_gaps()
    Vec3f place{0.0F};
  };
  void run_passes();
  void seed();
  [[nodiscard]] bool run_pass();
  void finish(std::uint32_t edge, Obstacle obstacle);
  [[nodiscard]] bool is_locked(std::uint32_t vertex) const { return locks_.is_vertex_locked[vertex] != 0; }
  /// False where both ends are locked, which is counted, or where it is gone.
  [[nodiscard]] bool may_collapse(std::uint32_t edge);
  [[nodiscard]] std::uint32_t versions_of(const CollapseMesh::Ends& ends) const {
    return version_[ends[0]] + version_[ends[1]];
  }
  [[nodiscard]] double weigh(std::uint32_t edge);

  [[nodiscard]] Obstacle try_collapse(std::uint32_t edge, float cost);
  [[nodiscard]] Obstacle gather(const CollapseMesh::Ends& ends);
  [[nodiscard]] bool find_target(const Candidate& candidate);
  [[nodiscard]] Obstacle ask_guards(Candidate& candidate, float cost);
  [[nodiscard]] bool keep_gaps(std::uint32_t edge);
  [[nodiscard]] double weight_of_star() const;
  [[nodiscard]] Obstacle ask_price(float cost);
  void collapse();
  void tell_what_vanished();

  const SimplifyInput& input_;
  const SimplifyOptions& options_;
  GroupLocks locks_;
  CollapseMesh mesh_;
  GroupPlaces places_;
  std::optional<GroupPlaces> grown_;  ///< of foliage, at the end: values stay those of the places before
  CollapseCosts<Numbers, Capacity> costs_;
  LeftBehind left_behind_;
  PaintedGuard<Real, Capacity> painted_;
  GapGuard gaps_;
  std::optional<OwnPlaces> own_places_;  ///< where topology is kept
  std::vector<std::uint8_t> is_border_;  ///< per vertex
  std::vector<std::uint32_t> version_;   ///< per vertex
  std::vector<Candidate> candidates_;    ///< per edge
  EdgeHeap heap_;
  RefusedEdges refused_;
  Obstacles obstacles_;  ///< of the last pass
  double error2_ = 0.0;  ///< frame units, squared
  bool has_free_border_ = false, is_manifold_ = true, has_broken_topology_ = false, are_flips_relaxed_ = false;

  // Of the collapse that is tried.
  VertexMarks marks_;
  CollapseStar star_;
  Vec3i target_{0};
  double price_ = 0.0;  ///< where it is put back
  bool breaks_topology_ = false;
  std::vector<std::uint32_t> taken_up_;
};

template <class Numbers, std::size_t C>
GroupSimplifier<Numbers, C>::GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options)
    : input_(input),
      options_(options),
      locks_(input.is_locked, input.is_wedge_shared, input.wedge_position, input.is_border_locked),
      mesh_(input.triangles, input.wedge_position, input.positions.size()),
      places_(input.positions),
      costs_(input, options, mesh_, places_, locks_),
      left_behind_(input.witnesses, input.positions),
      painted_(input, options.painted, places_),
      gaps_(input, places_),
      version_(input.positions.size(), 0),
      marks_(input.positions.size()) {
  if (options.keep_topology) own_places_.emplace(input);
  const std::vector<EdgeUse> uses = sorted_edge_uses(mesh_);
  mesh_.number_edges(uses);
  HeldEdges held = find_held_edges(input, options, mesh_, uses);
  costs_.add_walls(held.edges);
  is_border_ = std::move(held.is_border);
  has_free_border_ = held.has_free_border;
  is_manifold_ = held.is_manifold;
  candidates_.resize(mesh_.edge_count());
}

template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::run() {
  run_passes();
  if (options_.may_relax_flips && mesh_.alive_count() > options_.target_triangles) {
    are_flips_relaxed_ = true;
    run_passes();
  }
  if (!options_.keep_area) return;
  grown_ = places_;
  const double farthest = grow_pieces(input_, mesh_, *grown_);
  error2_ = std::max(error2_, farthest * farthest);
}

template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::run_passes() {
  for (int pass = 0; pass < kMaxPasses && mesh_.alive_count() > options_.target_triangles; ++pass) {
    seed();
    // Obstacles depend on neighbours too, so what was refused is tried again as long as something moved.
    if (!run_pass()) break;
  }
}

template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::seed() {
  obstacles_ = {};
  heap_.clear();
  refused_.start(places_.size(), mesh_.edge_count());
  for (std::uint32_t edge = 0; edge < mesh_.edge_count(); ++edge) {
    if (may_collapse(edge)) heap_.append(weigh(edge), edge);
  }
  heap_.order();
}

/// Whether anything collapsed.
template <class Numbers, std::size_t C>
bool GroupSimplifier<Numbers, C>::run_pass() {
  bool any = false;
  while (!heap_.empty() && mesh_.alive_count() > options_.target_triangles) {
    const auto [cost, edge] = heap_.top();
    if (!may_collapse(edge)) {
      heap_.pop();
    } else if (candidates_[edge].versions != versions_of(mesh_.ends(edge))) {
      heap_.replace_top(weigh(edge));
    } else {
      const Obstacle obstacle = try_collapse(edge, cost);
      any |= obstacle == Obstacle::kNone;
      finish(edge, obstacle);
    }
  }
  return any;
}

template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::finish(std::uint32_t edge, Obstacle obstacle) {
  if (obstacle == Obstacle::kPutBack) return heap_.replace_top(price_);
  heap_.pop();
  if (obstacle == Obstacle::kNone) {
    for (const std::uint32_t again : taken_up_) {
      if (may_collapse(again)) heap_.push(weigh(again), again);
    }
  } else if (obstacle != Obstacle::kNoEdge) {
    obstacles_.add(obstacle);
    refused_.add(edge, mesh_.ends(edge));
  }
}

template <class Numbers, std::size_t C>
bool GroupSimplifier<Numbers, C>::may_collapse(std::uint32_t edge) {
  const CollapseMesh::Ends& ends = mesh_.ends(edge);
  if (ends[0] == CollapseMesh::kEnd) return false;
  if (!is_locked(ends[0]) || !is_locked(ends[1])) return true;
  obstacles_.add(Obstacle::kLocked);
  return false;
}

/// The cost of the edge; where its vertex would go is noted.
template <class Numbers, std::size_t C>
double GroupSimplifier<Numbers, C>::weigh(std::uint32_t edge) {
  const CollapseMesh::Ends& ends = mesh_.ends(edge);
  const auto [cost, place] = costs_.weigh(ends);
  candidates_[edge] = {versions_of(ends), false, false, Vec3f(place)};
  return cost;
}

template <class Numbers, std::size_t C>
Obstacle GroupSimplifier<Numbers, C>::try_collapse(std::uint32_t edge, float cost) {
  Obstacle obstacle = gather(mesh_.ends(edge));
  if (obstacle != Obstacle::kNone) return obstacle;
  costs_.collect_classes(star_);
  if (!find_target(candidates_[edge])) return Obstacle::kTopology;
  if (gaps_.is_on() && !keep_gaps(edge)) return Obstacle::kPutBack;
  obstacle = ask_guards(candidates_[edge], cost);
  if (obstacle != Obstacle::kNone) return obstacle;
  obstacle = ask_price(cost);
  if (obstacle != Obstacle::kNone) return obstacle;
  collapse();
  return Obstacle::kNone;
}

/// Of the two ends the locked one, if any, is a.
template <class Numbers, std::size_t C>
Obstacle GroupSimplifier<Numbers, C>::gather(const CollapseMesh::Ends& ends) {
  const std::size_t first = is_locked(ends[1]) ? 1 : 0;
  mesh_.gather(ends[first], star_.a);
  mesh_.gather(ends[1 - first], star_.b);
  if (star_.a.is_hub || star_.b.is_hub) return Obstacle::kCrowded;
  switch (gather_star(mesh_, marks_, star_)) {
    case Gathered::kTooMany: return Obstacle::kCrowded;
    case Gathered::kNoTriangle: return Obstacle::kNoEdge;
    case Gathered::kStar: break;
  }
  return Obstacle::kNone;
}

template <class Numbers, std::size_t C>
bool GroupSimplifier<Numbers, C>::find_target(const Candidate& candidate) {
  const Vec3i &at_a = places_.on_grid(star_.a.vertex), &at_b = places_.on_grid(star_.b.vertex);
  target_ = at_a;
  if (!is_locked(star_.a.vertex)) {
    target_ = places_.to_grid(Vec3d(candidate.place));
    if (own_places_ && !own_places_->find_free(at_a, at_b, target_)) return false;
  }
  star_.target = places_.to_frame(target_);
  return true;
}

/// A collapse that would move a surface too far into a gap gets another place, and waits for its turn at what it costs
/// there: false.
template <class Numbers, std::size_t C>
bool GroupSimplifier<Numbers, C>::keep_gaps(std::uint32_t edge) {
  Candidate& candidate = candidates_[edge];
  if (candidate.keeps_gaps || !(gaps_.excess(mesh_, places_, star_, star_.target) > 0.0)) return true;
  candidate.keeps_gaps = true;
  const Vec3d place = is_locked(star_.a.vertex) ? star_.target : gaps_.move_out(mesh_, places_, star_);
  candidate.place = Vec3f(place);
  const double excess = gaps_.excess(mesh_, places_, star_, place);
  price_ = costs_.weigh_at(mesh_.ends(edge), place) + kGapFactor * weight_of_star() * excess * excess;
  return false;
}

template <class Numbers, std::size_t C>
Obstacle GroupSimplifier<Numbers, C>::ask_guards(Candidate& candidate, float cost) {
  if (!keeps_shared_edges(mesh_, locks_, star_)) return Obstacle::kLocked;
  if (costs_.has_attributes()) {
    const WedgeClasses& classes = costs_.classes();
    if (!costs_.attributes().agree(classes, locks_) || falls_together(locks_, places_, star_)) return Obstacle::kSeams;
    if (costs_.has_seams() && !keeps_shared_corners(mesh_, locks_, classes, star_)) return Obstacle::kSeams;
  }
  breaks_topology_ = !keeps_topology(is_border_, star_);
  if (breaks_topology_) {
    if (!options_.may_relax_topology || options_.keep_topology) return Obstacle::kTopology;
    if (!candidate.may_break_topology) {
      candidate.may_break_topology = true;
      price_ = kTopologyPrice * double{cost};
      return Obstacle::kPutBack;
    }
  }
  if (options_.keep_topology && !keeps_to_itself(mesh_, locks_, star_)) return Obstacle::kTopology;
  if (breaks_topology_ || has_broken_topology_) move_sheets_out(star_);
  gather_facets(mesh_, places_, star_);
  return !are_flips_relaxed_ && turns_over(star_) ? Obstacle::kFlips : Obstacle::kNone;
}

/// What a squared distance costs that the collapse moves all that its vertex stands for by.
template <class Numbers, std::size_t C>
double GroupSimplifier<Numbers, C>::weight_of_star() const {
  const double weight = costs_.surface().weight(star_.a.vertex) + costs_.surface().weight(star_.b.vertex);
  return std::sqrt(std::max(2.0 * costs_.surface().total_weight() / mesh_.alive_count(), weight));
}

/// What leaving the old surface behind, or reaching beyond it, costs, and moving what is promised of what is painted:
/// where that is far more than the quadrics say, the collapse waits for its turn at that price.
template <class Numbers, std::size_t C>
Obstacle GroupSimplifier<Numbers, C>::ask_price(float cost) {
  const std::uint32_t a = star_.a.vertex, b = star_.b.vertex;
  const double per_distance2 = kGuardShare * weight_of_star();
  const auto is_too_much = [&](double price) {
    price_ = price;
    return EdgeHeap::key_of(price) > cost;
  };
  const auto affordable2 = [&](double per2) { return per2 > 0.0 ? double{cost} / per2 : 0.0; };

  const bool is_manifold = is_manifold_ && !breaks_topology_, is_on_border = is_border_[a] != 0 && is_border_[b] != 0;
  const std::optional<float> left2 =
      left_behind_.weigh(mesh_, places_, marks_, star_, {is_manifold, is_on_border, options_.keep_area});
  if (!left2) return Obstacle::kCrowded;
  if (is_too_much(per_distance2 * double{*left2})) return Obstacle::kPutBack;
  // First what raises the price most, where it counts at all.
  if (painted_.is_on()) {
    const double per_painted2 = kPaintedFactor * per_distance2;
    const double moved2 = painted_.distance2(mesh_, places_, locks_, star_, costs_.classes(), costs_.attributes(),
                                             affordable2(per_painted2));
    if (is_too_much(per_painted2 * moved2)) return Obstacle::kPutBack;
  }
  const auto enough = static_cast<float>(affordable2(per_distance2));
  const float reached2 = new_surface_distance2(mesh_, places_, star_, enough);
  return reached2 > enough && is_too_much(per_distance2 * double{reached2}) ? Obstacle::kPutBack : Obstacle::kNone;
}

/// b becomes a.
template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::collapse() {
  const std::uint32_t a = star_.a.vertex, b = star_.b.vertex;
  has_broken_topology_ |= breaks_topology_;
  is_manifold_ &= !breaks_topology_;
  error2_ = std::max(error2_, costs_.join(star_));
  left_behind_.join(a, b);
  is_border_[a] |= is_border_[b];
  if (own_places_) own_places_->join(places_.on_grid(a), places_.on_grid(b), target_);
  places_.move(a, target_);
  for (std::size_t k = 0; k < star_.sheets().size(); k += 2) {
    error2_ = std::max(error2_, height2_of_sheet(mesh_, places_, star_, star_.sheets()[k], true));
  }
  mesh_.join(star_.a, star_.b, star_.gone(), star_.on_edge, is_manifold_);
  costs_.update(star_);
  tell_what_vanished();
  version_[a] += version_[b] + 1;
  taken_up_.clear();
  refused_.take(a, taken_up_);
  refused_.take(b, taken_up_);
}

/// Pieces and sheets that are no more were as large as what their vertices stood for.
template <class Numbers, std::size_t C>
void GroupSimplifier<Numbers, C>::tell_what_vanished() {
  if (star_.outer_count == 0) error2_ = std::max(error2_, left_behind_.size2(star_.a.vertex, places_));
  for (const std::uint32_t t : star_.sheets()) {
    for (std::uint32_t corner = 3 * t; corner < 3 * t + 3; ++corner) {
      const std::uint32_t v = mesh_.vertex(corner);
      const bool has_corners = mesh_.any_corner(v, [](std::uint32_t) { return true; });
      if (v != star_.b.vertex && !has_corners) error2_ = std::max(error2_, left_behind_.size2(v, places_));
    }
  }
}

template <class Numbers, std::size_t C>
SimplifyResult GroupSimplifier<Numbers, C>::result() const {
  SimplifyResult out =
      write_group(input_, mesh_, grown_ ? *grown_ : places_, left_behind_,
                  [&](std::uint32_t v, std::uint32_t wedge, std::vector<float>& to) {
                    costs_.attributes().write(wedge, locks_.is_wedge_locked[wedge] != 0, places_[v], to);
                  });
  out.quadric_error = std::sqrt(error2_) * places_.scale() * input_.grid.step();
  if (mesh_.alive_count() > options_.target_triangles) {
    out.reason = obstacles_.reason(count_pieces(mesh_, places_.size()), options_.target_triangles);
  }
  out.crowded = obstacles_.count(Obstacle::kCrowded);
  return out;
}

}  // namespace meshlode::builder
