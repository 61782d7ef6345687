// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/bounded_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "builder/deviation/linear_bounds.h"

namespace meshlode::builder {

namespace {

/// A search ends at what is within this share of what is known: it bounds nearly as well as what is nearest, and is
/// found sooner.
constexpr double kEnough = 0.1;
/// What is farther by no more than this share is not looked for.
constexpr double kOfNoUse = 1e-3;
/// Of the tree's extent: what floats tell apart, and as much again.
constexpr double kSmallest = 2e-7;
/// What is farther than the nearest by no more than this share of a part's bound is as near, and so is all in reach of
/// a part whose radius is that share: where two sheets lie in one place, neither is ever nearer.
constexpr double kTie = 2e-3;
/// An edge is not divided where another one is so many times as long, so that no needles come of it. Random scene
/// 1240183 builds in 0.9 s; in 75 s without; crystal.glb takes as long with as without.
constexpr double kNeedle = 2.0;
/// No division nearer to the end of an edge, as a share of it.
constexpr double kFromEnd = 1e-3;

}  // namespace

BoundedSearch::BoundedSearch(const SurfaceTree& tree, double margin, double known)
    : tree_(&tree), margin_(margin), beyond_(std::max(margin * known, kSmallest / tree.scale())) {}

BoundedSearch::BoundedSearch(const SurfaceTree& tree, double margin, std::span<const double> known, PartOf part_of)
    : BoundedSearch(tree, margin, *std::min_element(known.begin(), known.end())) {
  limits_.assign(known.size(), {beyond_, 0.0});
  part_of_ = std::move(part_of);
  know(known);
}

void BoundedSearch::add(const std::array<Vec3d, 3>& corners, TreeSlot place) {
  if (is_near_throughout(corners, place)) return;
  Part part;
  for (std::size_t k = 0; k < 3; ++k) part.corner[k] = {corners[k], place};
  look_at(part);
}

void BoundedSearch::add_later(const std::array<Vec3d, 3>& corners, TreeSlot place, double bound) {
  if (!is_beyond(bound)) return;
  Part part;
  for (std::size_t k = 0; k < 3; ++k) part.corner[k] = {corners[k], place};
  part.is_new = true;
  part.bound = bound;
  push(part);
}

void BoundedSearch::look_at(Part& part) {
  part.is_new = false;
  for (Corner& corner : part.corner) {
    if (!measure(corner)) return;
  }
  if (!is_within(part)) push(part);
}

void BoundedSearch::know(double known) {
  beyond_ = std::max(beyond_, margin_ * known);
}

void BoundedSearch::know(std::span<const double> known) {
  for (std::size_t i = 0; i < limits_.size(); ++i) limits_[i].beyond = std::max(limits_[i].beyond, margin_ * known[i]);
  take_least();
}

void BoundedSearch::take_least() {
  double least = std::numeric_limits<double>::infinity();
  for (const Limit& limit : std::span(limits_).first(limits_.size() - 1)) least = std::min(least, limit.beyond);
  Limit& of_none = limits_.back();
  if (limits_.size() > 1) of_none.beyond = std::max(of_none.beyond, least);
  beyond_ = std::min(least, of_none.beyond);
}

std::size_t BoundedSearch::run(std::size_t parts) {
  std::size_t made = 0;
  while (!is_done() && made + 2 <= parts) {
    std::pop_heap(parts_.begin(), parts_.end());
    Part part = parts_.back();
    parts_.pop_back();
    if (part.is_new) {
      look_at(part);
      continue;
    }
    made += 2;
    const auto [from, share] = choose_division(part);
    const std::size_t to = (from + 1) % 3;
    Corner middle{(1.0 - share) * part.corner[from].at + share * part.corner[to].at, part.corner[from].near};
    if (!measure(middle)) continue;
    for (const std::size_t replaced : {from, to}) {
      Part half = part;
      half.corner[replaced] = middle;
      if (!is_within(half)) push(half);
    }
  }
  return made;
}

void BoundedSearch::push(Part& part) {
  part.order = made_++;
  parts_.push_back(part);
  std::push_heap(parts_.begin(), parts_.end());
}

bool BoundedSearch::is_beyond(double distance, double limit) {
  return distance > limit * (1.0 + kOfNoUse);
}

void BoundedSearch::take(const Found& found) {
  if (found.distance > found_.distance) found_ = found;
  if (limits_.empty()) {
    beyond_ = margin_ * found.distance;
    return;
  }
  const std::size_t part = part_of_(tree_->triangle_at(found.place));
  limits_[part].found = found.distance;
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    if (i == part || part + 1 == limits_.size())
      limits_[i].beyond = std::max(limits_[i].beyond, margin_ * found.distance);
  }
  take_least();
}

bool BoundedSearch::is_near_throughout(const std::array<Vec3d, 3>& corners, TreeSlot place) const {
  if (!place.is_valid()) return false;
  const std::array<Vec3f, 3> at{tree_->to_frame(corners[0]), tree_->to_frame(corners[1]), tree_->to_frame(corners[2])};
  const SurfaceTree::Hit hit = tree_->look_around(at, place);
  if (!(hit.distance2 <= tree_->squared_in_frame(beyond_))) return false;
  // Floats are off by a share of the extent, and what is beyond may be a small one.
  const TriangleDistance distance(tree_->corners_at(hit.slot));
  return std::all_of(corners.begin(), corners.end(),
                     [&](const Vec3d& p) { return distance.squared_to(p) <= beyond_ * beyond_; });
}

SurfaceTree::Hit BoundedSearch::find_near(const Corner& corner, float enough) const {
  const Vec3f at = tree_->to_frame(corner.at);
  SurfaceTree::Hit hit;
  if (corner.near.is_valid()) hit = tree_->look_around(at, corner.near, hit);
  return hit.distance2 <= enough ? hit : tree_->find_nearest(at, hit, enough);
}

bool BoundedSearch::measure(Corner& corner) {
  const SurfaceTree::Hit hit = find_near(corner, tree_->squared_in_frame(kEnough * beyond_));
  if (!hit.slot.is_valid()) return false;  // farther than floats reach: not on any real mesh
  corner.near = hit.slot;
  const double distance = std::sqrt(tree_->distance2_at(corner.at, hit.slot));
  if (distance > beyond_ && distance > beyond_at(hit.slot)) take({distance, corner.at, hit.slot});
  return true;
}

bool BoundedSearch::is_within(Part& part) {
  LinearBounds bounds;
  const auto bound_by = [&](TreeSlot slot) {
    if (!slot.is_valid() || bounds.has(slot)) return false;
    const TriangleDistance distance(tree_->corners_at(slot));
    for (std::size_t k = 0; k < 3; ++k) {
      bounds.at_corner[bounds.count][k] = std::sqrt(distance.squared_to(part.corner[k].at));
    }
    bounds.of[bounds.count++] = slot;
    return true;
  };
  const auto is_enough = [&] {
    if (!is_beyond(part.bound)) return true;
    if (limits_.empty()) return false;
    for (std::size_t k = 0; k < bounds.count; ++k) {
      if (may_be_beyond(tree_->triangle_at(bounds.of[k]), part, bounds)) return false;
    }
    return !is_any_in_reach(part, bounds);
  };
  for (const Corner& corner : part.corner) bound_by(corner.near);
  bound_by(part.near_peak);
  for (;;) {
    const auto [value, weight] = highest_of(bounds);
    part.bound = std::min(part.bound, value);
    if (is_enough()) return true;
    part.peak_edge = Part::kInside;
    for (std::uint8_t k = 0; k < 3; ++k) {
      if (weight[(k + 2U) % 3] == 0.0) part.peak_edge = k;
    }
    if (bounds.count == kMostBounds) return false;
    Corner peak{Vec3d(0.0), part.corner[0].near};
    for (std::size_t k = 0; k < 3; ++k) peak.at += weight[k] * part.corner[k].at;
    if (!measure(peak)) return true;
    part.near_peak = peak.near;
    if (!bound_by(peak.near)) return is_enough();
  }
}

bool BoundedSearch::may_be_beyond(std::uint32_t triangle, const Part& part, const LinearBounds& bounds) const {
  const double limit = limits_[part_of_(triangle)].beyond;
  if (!is_beyond(part.bound, limit)) return false;
  const std::array<Vec3d, 3> corners{part.corner[0].at, part.corner[1].at, part.corner[2].at};
  return is_beyond(most_where_nearest(tree_->corners_of(triangle), corners, bounds, kTie * part.bound), limit);
}

bool BoundedSearch::is_any_in_reach(const Part& part, const LinearBounds& bounds) {
  const Vec3d middle = (part.corner[0].at + part.corner[1].at + part.corner[2].at) / 3.0;
  double radius2 = 0.0;
  for (const Corner& corner : part.corner) {
    const Vec3d away = corner.at - middle;
    radius2 = std::max(radius2, glm::dot(away, away));
  }
  const double radius = std::sqrt(radius2), reach = part.bound + radius + kSmallest / tree_->scale();
  const auto is_known_to_less = [&](std::uint32_t triangle) { return may_be_beyond(triangle, part, bounds); };
  for (;;) {
    const float reach2 = tree_->squared_in_frame(reach + kSmallest / tree_->scale());
    const TreeSlot near = tree_->find_nearest_of(tree_->to_frame(middle), {TreeSlot(), reach2}, is_known_to_less).slot;
    if (!near.is_valid() || tree_->distance2_at(middle, near) > reach * reach) return false;
    if (radius > kTie * part.bound) return true;
    take({part.bound, middle, near});
  }
}

/// Where triangles of the surface that meet in an edge cover the part together, no single one is near to it throughout;
/// but two are to its halves, if it is divided at that edge: where it is as far to the one as to the other, by what the
/// distances to them are at the ends. Else in the middle of the longest edge, so that no needles come of it.
BoundedSearch::Division BoundedSearch::choose_division(const Part& part) const {
  const Division longest{part.longest_edge(), 0.5};
  if (part.peak_edge == Part::kInside) return longest;
  const Corner &from = part.corner[part.peak_edge], &to = part.corner[(part.peak_edge + 1U) % 3];
  const Vec3d edge = to.at - from.at, most = part.corner[(longest.edge + 1) % 3].at - part.corner[longest.edge].at;
  if (kNeedle * kNeedle * glm::dot(edge, edge) < glm::dot(most, most)) return longest;
  const auto how_much_farther = [&](const Corner& corner, TreeSlot other) {
    return std::sqrt(tree_->distance2_at(corner.at, other)) - std::sqrt(tree_->distance2_at(corner.at, corner.near));
  };
  const double at_from = how_much_farther(from, to.near), at_to = how_much_farther(to, from.near);
  const double share = at_from / (at_from + at_to);
  if (at_from > 0.0 && at_to > 0.0 && share > kFromEnd && share < 1.0 - kFromEnd) return {part.peak_edge, share};
  return longest;
}

std::uint8_t BoundedSearch::Part::longest_edge() const {
  const auto length2 = [&](std::size_t k) {
    const Vec3d along = corner[(k + 1) % 3].at - corner[k].at;
    return glm::dot(along, along);
  };
  const double first = length2(0), second = length2(1), third = length2(2);
  if (first >= second && first >= third) return 0;
  return second >= third ? 1 : 2;
}

}  // namespace meshlode::builder
