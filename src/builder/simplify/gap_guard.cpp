// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/gap_guard.h"

#include <algorithm>
#include <cmath>

#include "builder/simplify/placement.h"

namespace meshlode::builder {

namespace {

// Chosen on 60 layered scenes (random_scenes --layers, seeds 830000 to 830059), as is kGapFactor (group_simplifier.h):
// the pictures that V211 finds, and the triangles that are drawn. Without: 189, 3,307,036.
//   kShare      0.25       0.5        0.5        0.5        0.5        0.5
//   kMostMoves  8          1          8          8          8          8
//   kGapFactor  64         64         0          16         256        64
//   pictures    7          20         32         5          2          6
//   triangles   3,845,639  3,722,972  3,584,226  3,658,163  3,730,707  3,696,079

/// Of a gap. One half each: two surfaces that move so far do not cross.
constexpr double kShare = 0.5;
/// Planes that a place is moved to the right side of, one after the other, the farthest first.
constexpr int kMostMoves = 8;

}  // namespace

GapGuard::GapGuard(const SimplifyInput& input, const GroupPlaces& places) : labels_(input.triangle_material) {
  if (!(input.gap_reach > 0.0)) return;
  is_on_ =
      std::any_of(labels_.begin(), labels_.end(), [](std::uint32_t label) { return gap_pair_of(label).byte() != 0; });
  const double step = input.grid.step();
  for (std::uint32_t code = 1; code <= kNarrowestGap; ++code) {
    // A vertex is rounded to the grid, by less than a step.
    allowed_[code] = (kShare * gap_of_code(code, input.gap_reach) / step + 1.0) / places.scale();
  }
}

GapGuard::Worst GapGuard::find_worst(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star,
                                     const Vec3d& place) const {
  Worst worst;
  for (const Ring* end : {&star.a, &star.b}) {
    for (const std::uint32_t corner : end->corners()) {
      const std::uint32_t t = corner / 3;
      const GapPair gaps = gap_pair_of(labels_[t]);
      if (gaps.byte() == 0) continue;
      const Vec3d& p = places[mesh.vertex(3 * t)];
      Vec3d normal = glm::cross(places[mesh.vertex(3 * t + 1)] - p, places[mesh.vertex(3 * t + 2)] - p);
      const double length = std::sqrt(glm::dot(normal, normal));
      if (!(length > 0.0)) continue;
      normal /= length;
      const double height = glm::dot(normal, place - p);
      if (gaps.above != 0 && height - allowed_[gaps.above] > worst.excess) {
        worst = {height - allowed_[gaps.above], -normal};
      }
      if (gaps.below != 0 && -height - allowed_[gaps.below] > worst.excess) {
        worst = {-height - allowed_[gaps.below], normal};
      }
    }
  }
  return worst;
}

Vec3d GapGuard::move_out(const CollapseMesh& mesh, const GroupPlaces& places, const CollapseStar& star) const {
  Vec3d place = star.target;
  for (int i = 0; i < kMostMoves; ++i) {
    const Worst worst = find_worst(mesh, places, star, place);
    if (!(worst.excess > 0.0)) break;
    place += worst.out * worst.excess;
  }
  return is_near_edge(place, places[star.a.vertex], places[star.b.vertex]) ? place : star.target;
}

}  // namespace meshlode::builder
