// SPDX-License-Identifier: GPL-3.0-or-later
// The simplifier's state and steps, for at most Capacity attributes. Used by simplify.cpp alone.
//
// Order of collapses: E / √W, E the area-weighted quadric error at the new place and W the summed area. It beats E
// because E grows with the area behind a vertex, not only with how far the surface moves.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <span>
#include <vector>

#include "base/disjoint_sets.h"
#include "build/simplify/collapse_mesh.h"
#include "build/simplify/collapse_star.h"
#include "build/simplify/group_locks.h"
#include "build/simplify/group_places.h"
#include "build/simplify/guards.h"
#include "build/simplify/left_behind.h"
#include "build/simplify/quadric.h"
#include "build/simplify/simplify.h"
#include "build/simplify/wedge_classes.h"

namespace meshlode::build {

template <std::size_t Capacity>
class GroupSimplifier {
 public:
  GroupSimplifier(const SimplifyInput& input, const SimplifyOptions& options);
  void run();
  [[nodiscard]] SimplifyResult result() const;
  /// Whether an edge of the border has an end that may move. Without one the border's image is the border.
  [[nodiscard]] bool has_free_border() const { return has_free_border_; }

 private:
  using Wedge = WedgeQuadric<Capacity>;
  using Values = std::array<double, Capacity>;

  /// Weight of the pull towards the collapsed edge: places vertices sensibly where the surface is flat, and lets short
  /// edges go first there. A share of the squared edge length, far below any deviation that matters.
  static constexpr double kRegularization = 1e-6;
  /// How far from the edge's middle a new vertex may lie, in edge lengths.
  static constexpr double kMaxOffset = 1.5;
  static constexpr int kMaxPasses = 8;
  static constexpr double kMaxGrowth = 2.0;   ///< of a piece's size in one level
  /// A collapse costs at least this share of what its largest displacement, of the old surface from the new or of the new
  /// from the old, would cost as a mean distance.
  static constexpr double kGuardShare = 0.7;
  /// What breaking the link condition costs, as a factor: small holes and handles close when everything else has become
  /// about ten times as far off.
  static constexpr double kTopologyPrice = 10.0;

  struct Candidate {
    double cost;
    std::uint32_t a, b;                  ///< a < b
    std::uint32_t version_a, version_b;  ///< stale if a vertex has changed since
    bool may_break_topology = false;     ///< the cost already counts that the link condition is broken
    bool operator>(const Candidate& other) const {
      if (cost != other.cost) return cost > other.cost;
      return a != other.a ? a > other.a : b > other.b;
    }
  };
  struct Placement {
    Vec3d position{0.0};
    double cost = 0.0;
  };
  enum class Obstacle : std::uint8_t { kNone, kLocked, kFlips, kSeams, kTopology, kPutBack };

  void scale_attributes();
  void add_face_quadrics();
  void add_edge_quadrics();
  void seed_candidates();
  void push_candidate(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] Placement place(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] bool agree(const WedgeClass& joined) const;
  [[nodiscard]] Obstacle try_collapse(const Candidate& candidate);
  [[nodiscard]] double price_of(const Candidate& candidate);
  void collapse(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] bool has_corners_in_one_place(std::uint32_t triangle) const;
  void run_passes();
  [[nodiscard]] std::vector<std::uint32_t> find_pieces() const;
  void grow_pieces();
  [[nodiscard]] double drop_collapsed_sheets(std::uint32_t vertex);
  [[nodiscard]] StuckReason reason_for_stopping() const;

  const SimplifyInput& input_;
  const SimplifyOptions& options_;
  GroupLocks locks_;
  CollapseMesh mesh_;
  GroupPlaces places_;
  std::size_t attribute_count_;
  std::vector<double> attribute_scale_;       ///< stored value -> weighted value

  std::vector<Quadric> plane_, border_, seam_;  ///< per vertex; seam_ is empty where there is none
  LeftBehind left_behind_;
  double total_weight_ = 0.0;                   ///< of all plane quadrics
  std::vector<std::uint32_t> version_;
  std::vector<std::uint8_t> is_border_;

  std::vector<Wedge> wedge_;
  std::vector<Values> value_;

  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue_;
  double error_ = 0.0;  ///< frame units
  bool has_free_border_ = false, has_broken_topology_ = false, are_flips_relaxed_ = false;
  std::array<std::uint64_t, 6> obstacles_{};

  // Scratch of one collapse.
  CollapseStar star_;
  StarEnd joined_;
  WedgeClasses classes_;
};

}  // namespace meshlode::build
