// SPDX-License-Identifier: GPL-3.0-or-later
// The simplifier's queue and passes, for at most Capacity attributes. Used by simplify.cpp alone. What a collapse
// costs, what may not be collapsed and what is left behind are types and functions of their own, each in its file.
//
// Order of collapses: E / √W, E the area-weighted quadric error at the new place and W the summed area. It beats E
// because E grows with the area behind a vertex, not only with how far the surface moves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "builder/simplify/attribute_quadrics.h"
#include "builder/simplify/attribute_scales.h"
#include "builder/simplify/candidate_queue.h"
#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/edge_uses.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/guards.h"
#include "builder/simplify/held_edges.h"
#include "builder/simplify/kept_topology.h"
#include "builder/simplify/left_behind.h"
#include "builder/simplify/new_surface.h"
#include "builder/simplify/painted_guard.h"
#include "builder/simplify/pieces.h"
#include "builder/simplify/placement.h"
#include "builder/simplify/simplify.h"
#include "builder/simplify/surface_quadrics.h"
#include "builder/simplify/wedge_classes.h"

namespace meshlode::builder {

/// `Real` is what its quadrics are summed and solved in.
template <class Real, std::size_t Capacity>
class GroupSimplifier {
 public:
  /// Both must outlive this.
  GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options);
  void run();
  [[nodiscard]] SimplifyResult result() const;
  /// Whether an edge of the border has an end that may move. Without one the border's image is the border.
  [[nodiscard]] bool has_free_border() const { return has_free_border_; }

 private:
  static constexpr int kMaxPasses = 8;
  /// A collapse costs at least this share of what its largest displacement, of the old surface from the new or of the
  /// new from the old, would cost as a mean distance.
  static constexpr double kGuardShare = 0.7;
  /// So many times that for what is painted, where that is promised: its largest distance alone then orders collapses
  /// that move it. (With 1 cuts that keep a promise need more triangles, with 64 no fewer.)
  static constexpr double kPaintedFactor = 16.0;
  /// What breaking the link condition costs, as a factor: small holes and handles close when everything else has become
  /// about ten times as far off.
  static constexpr double kTopologyPrice = 10.0;

  struct Placement {
    Vec3d position{0.0};
    double cost = 0.0;
  };
  /// Where make_candidate() has put a vertex.
  struct Placed {
    Vec3d position{0.0};
    std::uint32_t a = kNoId, b = kNoId, versions = 0;
  };
  /// The last two are none: the candidate waits at another price, or its edge went with a sheet.
  enum class Obstacle : std::uint8_t { kNone, kLocked, kFlips, kSeams, kTopology, kPutBack, kNoEdge };

  void add_faces();
  void run_passes();
  void seed_candidates();
  /// False where both ends are locked, which is counted.
  [[nodiscard]] bool is_free_to_collapse(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] Candidate make_candidate(std::uint32_t a, std::uint32_t b);
  /// Weighs a candidate again whose ends have changed or been joined into others. False where they have become one, or
  /// may not.
  [[nodiscard]] bool refresh(Candidate& candidate);
  /// The vertex that a vertex was joined into, or itself.
  [[nodiscard]] std::uint32_t vertex_of(std::uint32_t joined);
  void set_aside(const Candidate& refused);
  void take_up_again(std::uint32_t vertex);
  /// Versions only grow: their sum is the same where neither has.
  [[nodiscard]] std::uint32_t versions_of(std::uint32_t a, std::uint32_t b) const { return version_[a] + version_[b]; }
  [[nodiscard]] double add_classes(BasicQuadric<Real>& total) const;
  [[nodiscard]] Vec3d place_again(std::uint32_t a, std::uint32_t b);
  /// Where a vertex goes whose place is not free.
  [[nodiscard]] const Vec3d& given_place(std::uint32_t a, std::uint32_t b) const {
    return places_[locks_.is_vertex_locked[a] != 0 ? a : b];
  }
  [[nodiscard]] Placement place(std::uint32_t a, std::uint32_t b, BasicQuadric<Real>& total, double fixed_error) const;
  [[nodiscard]] Obstacle try_collapse(const Candidate& candidate);
  [[nodiscard]] double price_of(const Candidate& candidate);
  void collapse(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] bool has_corners_in_one_place(std::uint32_t triangle) const;
  [[nodiscard]] StuckReason reason_for_stopping() const;

  const SimplifyInput& input_;
  const SimplifyOptions& options_;
  GroupLocks locks_;
  CollapseMesh mesh_;
  GroupPlaces places_;
  SurfaceQuadrics<Real> surface_;
  AttributeQuadrics<Real, Capacity> attributes_;
  WedgeClasses classes_;
  LeftBehind left_behind_;
  std::optional<OwnPlaces> own_places_;     ///< where topology is kept
  std::vector<std::uint8_t> is_border_;     ///< per vertex
  std::vector<std::uint32_t> version_;      ///< per vertex
  std::vector<std::uint32_t> joined_into_;  ///< per vertex, itself where it was not joined into another

  std::vector<EdgeUse> edge_uses_;  ///< before the first collapse; then nothing
  CandidateQueue queue_;
  std::vector<std::vector<std::uint32_t>> refused_;  ///< per vertex: the other ends of candidates that were refused
  std::array<std::uint64_t, 7> obstacles_{};
  Placed last_placed_;
  double error_ = 0.0;  ///< frame units
  bool has_free_border_ = false, has_broken_topology_ = false, are_flips_relaxed_ = false;

  VertexMarks marks_;
  CollapseStar star_;  ///< of the collapse that is weighed or done
  StarEnd joined_;     ///< the vertex that came of it
  NewSurface new_surface_;
  PaintedGuard<Real, Capacity> painted_;
};

template <class Real, std::size_t C>
GroupSimplifier<Real, C>::GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options)
    : input_(input),
      options_(options),
      locks_(input.is_locked, input.is_wedge_shared, input.wedge_position, input.is_border_locked),
      mesh_(input.triangles, input.wedge_position, input.positions.size()),
      places_(input.positions),
      surface_(input.positions.size(), options.border_weight),
      attributes_(input, attribute_scales(input, options, mesh_, places_)),
      classes_(attributes_.count() == 0 ? 0 : input.wedge_position.size(), input.positions.size()),
      left_behind_(input.witnesses, places_),
      version_(input.positions.size(), 0),
      joined_into_(input.positions.size()),
      marks_(input.positions.size()),
      painted_(input, options.painted, places_) {
  std::iota(joined_into_.begin(), joined_into_.end(), 0U);
  if (options.keep_topology) own_places_.emplace(input);
  add_faces();
  HeldEdges held = find_held_edges(input, options, mesh_);
  surface_.add_walls(held.edges, mesh_, places_);
  is_border_ = std::move(held.is_border);
  has_free_border_ = held.has_free_border;
  edge_uses_ = std::move(held.uses);
  classes_.start(mesh_);
}

template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::add_faces() {
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t)) continue;
    const Face face = face_of(mesh_, places_, t);
    if (!(face.twice_area > 0.0)) continue;
    surface_.add_face({mesh_.vertex(3 * t), mesh_.vertex(3 * t + 1), mesh_.vertex(3 * t + 2)}, face);
    if (attributes_.count() == 0) continue;
    attributes_.add_face({mesh_.wedge(3 * t), mesh_.wedge(3 * t + 1), mesh_.wedge(3 * t + 2)}, face);
  }
}

template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::run() {
  run_passes();
  if (options_.may_relax_flips && mesh_.alive_count() > options_.target_triangles) {
    are_flips_relaxed_ = true;
    run_passes();
  }
  if (options_.keep_area) error_ = std::max(error_, grow_pieces(input_, mesh_, places_));
}

template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::run_passes() {
  for (int pass = 0; pass < kMaxPasses && mesh_.alive_count() > options_.target_triangles; ++pass) {
    obstacles_.fill(0);
    queue_.clear();
    refused_.assign(places_.size(), {});
    seed_candidates();
    bool any = false;
    Candidate last{-1.0, 0, 0, 0};
    while (!queue_.empty() && mesh_.alive_count() > options_.target_triangles) {
      Candidate candidate = queue_.front();
      if (versions_of(candidate.a, candidate.b) != candidate.versions) {
        if (refresh(candidate)) {
          queue_.replace_front(candidate);
        } else {
          (void)queue_.pop();
        }
        continue;
      }
      (void)queue_.pop();
      // Edges that have become one, or that both of their ends took up again, follow one another.
      if (candidate == last) continue;
      last = candidate;
      const Obstacle obstacle = try_collapse(candidate);
      if (obstacle == Obstacle::kNone) {
        any = true;
      } else {
        ++obstacles_[static_cast<std::size_t>(obstacle)];
        if (obstacle < Obstacle::kPutBack) set_aside(candidate);
      }
    }
    if (!any)
      break;  // obstacles depend on neighbours too, so what was refused is tried again as long as something moved
  }
}

template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::seed_candidates() {
  std::vector<EdgeUse> uses;
  std::swap(uses, edge_uses_);
  if (uses.empty()) uses = sorted_edge_uses(mesh_);
  for (std::size_t i = 0; i < uses.size(); ++i) {
    if (i > 0 && uses[i].a == uses[i - 1].a && uses[i].b == uses[i - 1].b) continue;
    if (is_free_to_collapse(uses[i].a, uses[i].b)) queue_.append(make_candidate(uses[i].a, uses[i].b));
  }
  queue_.order();
}

template <class Real, std::size_t C>
bool GroupSimplifier<Real, C>::is_free_to_collapse(std::uint32_t a, std::uint32_t b) {
  if (locks_.is_vertex_locked[a] == 0 || locks_.is_vertex_locked[b] == 0) return true;
  ++obstacles_[static_cast<std::size_t>(Obstacle::kLocked)];
  return false;
}

template <class Real, std::size_t C>
Candidate GroupSimplifier<Real, C>::make_candidate(std::uint32_t a, std::uint32_t b) {
  if (a > b) std::swap(a, b);
  star_.a.vertex = a;
  star_.b.vertex = b;
  BasicQuadric<Real> total = surface_.around(a, b);
  double fixed_error = 0.0;
  if (classes_.needs_corners(a, b)) {
    gather_corners(mesh_, a, b, star_);
    classes_.collect(mesh_, locks_, star_);
    fixed_error = add_classes(total);
  } else if (attributes_.count() > 0) {
    fixed_error = attributes_.add_pair(total, classes_.pair_of(locks_, a, b), given_place(a, b));
  }
  const Placement placement = place(a, b, total, fixed_error);
  last_placed_ = {placement.position, a, b, versions_of(a, b)};
  return {placement.cost, a, b, versions_of(a, b)};
}

/// What the wedge classes of the star add to it. \pre they are collected
template <class Real, std::size_t C>
double GroupSimplifier<Real, C>::add_classes(BasicQuadric<Real>& total) const {
  return attributes_.add_classes(total, classes_.classes(), given_place(star_.a.vertex, star_.b.vertex));
}

/// Where the vertex of a candidate goes that is tried, and its wedge classes with it: what comes up is often what was
/// weighed last. \pre the star's corners are gathered
template <class Real, std::size_t C>
Vec3d GroupSimplifier<Real, C>::place_again(std::uint32_t a, std::uint32_t b) {
  classes_.collect(mesh_, locks_, star_);
  if (locks_.is_vertex_locked[a] != 0 || locks_.is_vertex_locked[b] != 0) return given_place(a, b);
  if (last_placed_.a == a && last_placed_.b == b && last_placed_.versions == versions_of(a, b)) {
    return last_placed_.position;
  }
  BasicQuadric<Real> total = surface_.around(a, b);
  const double fixed_error = add_classes(total);
  return place(a, b, total, fixed_error).position;
}

template <class Real, std::size_t C>
std::uint32_t GroupSimplifier<Real, C>::vertex_of(std::uint32_t joined) {
  while (joined_into_[joined] != joined) {
    joined_into_[joined] = joined_into_[joined_into_[joined]];
    joined = joined_into_[joined];
  }
  return joined;
}

template <class Real, std::size_t C>
bool GroupSimplifier<Real, C>::refresh(Candidate& candidate) {
  const std::uint32_t a = vertex_of(candidate.a), b = vertex_of(candidate.b);
  if (a == b || !is_free_to_collapse(a, b)) return false;
  candidate = make_candidate(a, b);
  return true;
}

template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::set_aside(const Candidate& refused) {
  refused_[refused.a].push_back(refused.b);
  refused_[refused.b].push_back(refused.a);
}

/// What stood in the way depends on what is around the vertex, which has changed.
template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::take_up_again(std::uint32_t vertex) {
  const std::uint32_t a = vertex_of(vertex);
  std::vector<std::uint32_t>& others = refused_[vertex];
  // Each refusal is noted at both ends: without this, what one of them takes up again would be twice as much each time.
  for (std::uint32_t& other : others) other = vertex_of(other);
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  for (const std::uint32_t b : others) {
    if (a != b && is_free_to_collapse(a, b)) queue_.push(make_candidate(a, b));
  }
  others.clear();
}

/// Where the joined vertex goes and what it costs there: `total`, and the error of wedges whose values may not change
/// (only where the place is given).
template <class Real, std::size_t C>
typename GroupSimplifier<Real, C>::Placement GroupSimplifier<Real, C>::place(std::uint32_t a, std::uint32_t b,
                                                                             BasicQuadric<Real>& total,
                                                                             double fixed_error) const {
  const Vec3d& pa = places_[a];
  const Vec3d& pb = places_[b];
  const bool is_place_given = locks_.is_vertex_locked[a] != 0 || locks_.is_vertex_locked[b] != 0;
  Placement placement;
  placement.position = is_place_given ? given_place(a, b) : place_vertex(total, pa, pb, options_.fallback);
  const Vec3d edge = pb - pa;
  placement.cost = cost_of_collapse(total, placement.position, fixed_error, glm::dot(edge, edge));
  return placement;
}

template <class Real, std::size_t C>
typename GroupSimplifier<Real, C>::Obstacle GroupSimplifier<Real, C>::try_collapse(const Candidate& candidate) {
  std::uint32_t a = candidate.a;
  std::uint32_t b = candidate.b;
  gather_corners(mesh_, a, b, star_);
  if (!has_shared_triangle(mesh_, star_)) return Obstacle::kNoEdge;
  star_.target = place_again(a, b);
  for (const WedgeClass& joined : classes_.classes()) {
    if (!attributes_.agree(joined, locks_)) return Obstacle::kSeams;
  }
  const bool is_free = locks_.is_vertex_locked[a] == 0 && locks_.is_vertex_locked[b] == 0;
  if (is_free) {
    Vec3i place = places_.to_grid(star_.target);
    if (own_places_ && !own_places_->find_free(places_.on_grid(a), places_.on_grid(b), place)) {
      return Obstacle::kTopology;
    }
    star_.target = places_.to_frame(place);
  }
  if (!keeps_shared_edges(mesh_, locks_, star_)) return Obstacle::kLocked;
  if (attributes_.count() > 0 &&
      (falls_together(mesh_, locks_, places_, star_) || !keeps_shared_corners(mesh_, locks_, classes_, star_))) {
    return Obstacle::kSeams;
  }
  bool breaks_topology = false;
  if (!keeps_topology(mesh_, is_border_, marks_, star_)) {
    if (!options_.may_relax_topology || options_.keep_topology) return Obstacle::kTopology;
    if (!candidate.may_break_topology) {
      queue_.push({kTopologyPrice * candidate.cost, a, b, versions_of(a, b), true});
      return Obstacle::kPutBack;
    }
    breaks_topology = true;
  }
  if (options_.keep_topology && !keeps_to_itself(mesh_, locks_, star_)) return Obstacle::kTopology;
  if (!are_flips_relaxed_ && turns_over(mesh_, places_, star_)) return Obstacle::kFlips;
  gather_outer_edges(mesh_, breaks_topology || has_broken_topology_, star_);
  const double price = price_of(candidate);
  if (price > candidate.cost) {
    queue_.push({price, a, b, versions_of(a, b), candidate.may_break_topology});
    return Obstacle::kPutBack;
  }
  has_broken_topology_ |= breaks_topology;
  if (locks_.is_vertex_locked[b] != 0) std::swap(a, b);
  collapse(a, b);
  return Obstacle::kNone;
}

/// What leaving the old surface behind, or reaching beyond it, costs, and moving what is promised of what is painted:
/// where that is far more than the quadrics say, the collapse waits for its turn at that price.
template <class Real, std::size_t C>
double GroupSimplifier<Real, C>::price_of(const Candidate& candidate) {
  const double left_behind2 = left_behind_.weigh(mesh_, places_, star_, options_.keep_area);
  const double mean_weight = 2.0 * surface_.total_weight() / mesh_.alive_count();
  const double weight = surface_.weight(candidate.a) + surface_.weight(candidate.b);
  const double price_of_distance2 = kGuardShare * std::sqrt(std::max(mean_weight, weight));
  const double price = price_of_distance2 * left_behind2;
  if (price > candidate.cost) return price;
  // First what raises the price most, where it counts at all.
  if (painted_.is_on()) {
    const double price_of_painted2 = kPaintedFactor * price_of_distance2;
    const double affordable2 = price_of_painted2 > 0.0 ? candidate.cost / price_of_painted2 : 0.0;
    const double moved2 = painted_.distance2(mesh_, places_, star_, classes_.classes(), attributes_, affordable2);
    if (moved2 > affordable2) return price_of_painted2 * moved2;
  }
  const double affordable2 = price_of_distance2 > 0.0 ? candidate.cost / price_of_distance2 : 0.0;
  const double reached2 = new_surface_.distance2(mesh_, places_, star_, affordable2);
  return reached2 > affordable2 ? price_of_distance2 * reached2 : price;
}

/// Joins b into a at the star's target. The star and the wedge classes are those of the pair.
template <class Real, std::size_t C>
void GroupSimplifier<Real, C>::collapse(std::uint32_t a, std::uint32_t b) {
  error_ = std::max(error_, surface_.join(a, b, star_.target));
  left_behind_.join(a, b);
  is_border_[a] |= is_border_[b];
  const Vec3i place_a = places_.on_grid(a), place_b = places_.on_grid(b);
  if (locks_.is_vertex_locked[a] == 0) places_.move(a, star_.target);
  if (own_places_) own_places_->join(place_a, place_b, places_.on_grid(a));
  for (const WedgeClass& c : classes_.classes()) {
    attributes_.join(c, places_[a]);
    relabel_wedges(mesh_, star_, c);
  }
  mesh_.merge_vertices(a, b);
  joined_into_[b] = a;
  ++version_[a];
  ++version_[b];

  if (has_broken_topology_) error_ = std::max(error_, left_behind_.drop_sheets(mesh_, places_, a));
  joined_.vertex = a;
  mesh_.corners_of(a, joined_.corners);
  classes_.update(mesh_, joined_);
  if (joined_.corners.empty()) error_ = std::max(error_, left_behind_.size(a));
  take_up_again(a);
  take_up_again(b);
}

template <class Real, std::size_t C>
StuckReason GroupSimplifier<Real, C>::reason_for_stopping() const {
  if (mesh_.alive_count() <= options_.target_triangles) return StuckReason::kNotStuck;
  const auto largest = std::max_element(obstacles_.begin() + 1, obstacles_.begin() + 5);
  if (static_cast<Obstacle>(largest - obstacles_.begin()) != Obstacle::kLocked) {
    // A piece keeps two triangles where it is closed: so many leave no room for the target, whatever refuses the last.
    if (2 * count_pieces(mesh_, places_.size()) > options_.target_triangles) return StuckReason::kComponents;
  }
  if (*largest == 0) return StuckReason::kTooSmall;
  switch (static_cast<Obstacle>(largest - obstacles_.begin())) {
    case Obstacle::kLocked: return StuckReason::kLocked;
    case Obstacle::kFlips: return StuckReason::kFlips;
    case Obstacle::kSeams: return StuckReason::kSeams;
    case Obstacle::kTopology: return StuckReason::kTopology;
    case Obstacle::kNone:
    case Obstacle::kPutBack:
    case Obstacle::kNoEdge: break;
  }
  return StuckReason::kTooSmall;
}

/// Two vertices may have come to lie on one point of the grid. A triangle with both has no area and no border by then.
template <class Real, std::size_t C>
bool GroupSimplifier<Real, C>::has_corners_in_one_place(std::uint32_t triangle) const {
  const Vec3i& p = places_.on_grid(mesh_.vertex(3 * triangle));
  const Vec3i& q = places_.on_grid(mesh_.vertex(3 * triangle + 1));
  const Vec3i& r = places_.on_grid(mesh_.vertex(3 * triangle + 2));
  return p == q || q == r || r == p;
}

template <class Real, std::size_t C>
SimplifyResult GroupSimplifier<Real, C>::result() const {
  SimplifyResult out;
  out.quadric_error = error_ * places_.scale() * input_.grid.step();
  out.reason = reason_for_stopping();
  const bool has_attributes = attributes_.count() > 0;  // without them a position is its own wedge
  std::vector<std::uint32_t> new_position(places_.size(), kNoId);
  // A wedge may have come to serve one vertex only, so a map per wedge is enough.
  std::vector<std::uint32_t> new_wedge(has_attributes ? input_.wedge_position.size() : places_.size(), kNoId);
  for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
    if (!mesh_.is_alive(t) || has_corners_in_one_place(t)) continue;
    WedgeTriangle triangle{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh_.vertex(3 * t + k);
      const std::uint32_t w = has_attributes ? mesh_.wedge(3 * t + k) : v;
      if (new_position[v] == kNoId) {
        new_position[v] = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(places_.on_grid(v));
        out.witnesses.push_back(left_behind_.witnesses(v));
      }
      if (new_wedge[w] == kNoId) {
        new_wedge[w] = static_cast<std::uint32_t>(out.wedge_position.size());
        out.wedge_position.push_back(new_position[v]);
        if (has_attributes) attributes_.write(w, locks_.is_wedge_locked[w] != 0, out.wedge_attributes);
      }
      triangle[k] = new_wedge[w];
    }
    out.triangles.push_back(triangle);
    out.triangle_material.push_back(input_.triangle_material[t]);
  }
  return out;
}

}  // namespace meshlode::builder
