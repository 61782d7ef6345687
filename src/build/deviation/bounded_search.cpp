// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/deviation/bounded_search.h"

#include <algorithm>
#include <cmath>

namespace meshlode::build {

std::array<BoundedSearch::Part, 4> BoundedSearch::Part::divided() const {
  std::array<Vec3d, 3> middle;
  for (std::size_t k = 0; k < 3; ++k) middle[k] = 0.5 * (corner[k] + corner[(k + 1) % 3]);
  std::array<Part, 4> parts;
  for (std::size_t k = 0; k < 3; ++k) parts[k] = {{corner[k], middle[k], middle[(k + 2) % 3]}, place, bound};
  parts[3] = {middle, place, bound};
  return parts;
}

void BoundedSearch::add(const std::array<Vec3d, 3>& corners, TreeSlot place) {
  Part part{corners, place};
  if (!is_within(part)) parts_.push_back(part);
}

void BoundedSearch::run(std::size_t parts) {
  std::make_heap(parts_.begin(), parts_.end());
  for (; !parts_.empty() && parts_.front().bound > beyond_ && parts >= 4; parts -= 4) {
    std::pop_heap(parts_.begin(), parts_.end());
    const Part part = parts_.back();
    parts_.pop_back();
    for (Part& child : part.divided()) {
      if (is_within(child)) continue;
      parts_.push_back(child);
      std::push_heap(parts_.begin(), parts_.end());
    }
  }
}

/// The middle may be what is farthest; no other point is farther than that by more than the way to it.
bool BoundedSearch::is_within(Part& part) {
  const Vec3d middle = (part.corner[0] + part.corner[1] + part.corner[2]) / 3.0;
  double radius = 0.0;
  for (const Vec3d& p : part.corner) radius = std::max(radius, glm::distance(p, middle));
  const float enough = tree_.squared_in_frame(std::max(0.0, beyond_ - radius));
  const Vec3f at = tree_.to_frame(middle);
  SurfaceTree::Hit hit;
  if (part.place.is_valid()) hit = tree_.look_around(at, part.place, hit);
  if (!(hit.distance2 <= enough)) hit = tree_.find_nearest(at, hit, enough);
  if (!hit.slot.is_valid()) return true;  // farther than floats reach: not on any real mesh
  part.place = hit.slot;
  if (hit.distance2 <= enough) return true;
  const double distance = std::sqrt(tree_.distance2_at(middle, hit.slot));
  if (distance > beyond_) {
    found_ = {distance, middle, hit.slot};
    beyond_ = margin_ * distance;
  }
  part.bound = std::min(part.bound, distance + radius);
  const std::array<Vec3f, 3> corners{tree_.to_frame(part.corner[0]), tree_.to_frame(part.corner[1]),
                                     tree_.to_frame(part.corner[2])};
  return tree_.look_around(corners, part.place).distance2 <= tree_.squared_in_frame(beyond_);
}

}  // namespace meshlode::build
