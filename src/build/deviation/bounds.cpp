// SPDX-License-Identifier: GPL-3.0-or-later
// Group to source, second part: by bounds, where bounds say much. The points of measure_to_source() may miss a narrow
// peak: beside the riser of a step one stood a quarter above all of them. Where the source's triangles are large
// against the deviation, a triangle of the group mostly lies within it of a single one, and then all of it does; only
// where that is not so it is divided, and little is left after little work. On smooth scans much would be left: a few
// triangles of the group say so, and the points, which tell enough there, are believed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "build/deviation/group_measure.h"

namespace meshlode::build {

namespace {

/// One triangle of so many is tried first, but so many at least. No more than this share of them may be left.
constexpr std::size_t kTriedOf = 16, kFewestTried = 32;
constexpr double kMostLeft = 1.0 / 3.0;
/// Parts that a group may be divided into: for each triangle, and besides.
constexpr std::size_t kPartsPerTriangle = 8, kPartsPerGroup = 1000;

/// Of a triangle of a group, or all of it.
struct Part {
  std::array<Vec3d, 3> corner;
  TreeSlot place;  ///< of the source's tree: where the search for what is nearest to its middle begins
  double bound = std::numeric_limits<double>::infinity();  ///< no point of it is farther from the source

  [[nodiscard]] bool operator<(const Part& other) const { return bound < other.bound; }
};

std::array<Part, 4> divided(const Part& part) {
  std::array<Vec3d, 3> middle;
  for (std::size_t k = 0; k < 3; ++k) middle[k] = 0.5 * (part.corner[k] + part.corner[(k + 1) % 3]);
  std::array<Part, 4> parts;
  for (std::size_t k = 0; k < 3; ++k) {
    parts[k] = {{part.corner[k], middle[k], middle[(k + 2) % 3]}, part.place, part.bound};
  }
  parts[3] = {middle, part.place, part.bound};
  return parts;
}

class BoundedSearch {
 public:
  BoundedSearch(const SurfaceTree& source, const GroupSurface& group, std::span<const TreeSlot> places, double margin,
                double known)
      : tree_(source), group_(group), places_(places), margin_(margin), beyond_(margin * known) {}

  [[nodiscard]] bool is_much_work() {
    const std::size_t step = std::clamp<std::size_t>(group_.triangles.size() / kFewestTried, 1, kTriedOf);
    std::size_t tried = 0, left = 0;
    for (std::size_t t = 0; t < group_.triangles.size(); t += step, ++tried) {
      Part part = whole(t);
      if (!is_within(part)) ++left;
    }
    return static_cast<double>(left) > kMostLeft * static_cast<double>(tried);
  }

  void run() {
    std::vector<Part> heap;
    for (std::size_t t = 0; t < group_.triangles.size(); ++t) {
      Part part = whole(t);
      if (!is_within(part)) heap.push_back(part);
    }
    std::make_heap(heap.begin(), heap.end());
    std::size_t budget = kPartsPerTriangle * group_.triangles.size() + kPartsPerGroup;
    for (; !heap.empty() && heap.front().bound > beyond_ && budget >= 4; budget -= 4) {
      std::pop_heap(heap.begin(), heap.end());
      const Part part = heap.back();
      heap.pop_back();
      for (Part& child : divided(part)) {
        if (is_within(child)) continue;
        heap.push_back(child);
        std::push_heap(heap.begin(), heap.end());
      }
    }
  }

  /// The farthest point that was beyond; 0: none.
  [[nodiscard]] double found() const { return found_; }

 private:
  [[nodiscard]] Part whole(std::size_t triangle) const {
    const auto& ids = group_.triangles[triangle];
    return {{group_.positions[ids[0]], group_.positions[ids[1]], group_.positions[ids[2]]}, places_[triangle]};
  }

  /// Whether all of a part is known not to be beyond. Its middle is measured, and may be what is farthest; no other
  /// point is farther than that by more than the way to it.
  [[nodiscard]] bool is_within(Part& part) {
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
      found_ = distance;
      beyond_ = margin_ * distance;
    }
    part.bound = std::min(part.bound, distance + radius);
    const std::array<Vec3f, 3> corners{tree_.to_frame(part.corner[0]), tree_.to_frame(part.corner[1]),
                                       tree_.to_frame(part.corner[2])};
    return tree_.look_around(corners, part.place).distance2 <= tree_.squared_in_frame(beyond_);
  }

  const SurfaceTree& tree_;
  const GroupSurface& group_;
  std::span<const TreeSlot> places_;
  double margin_, beyond_;  ///< no nearer point is of use
  double found_ = 0.0;
};

}  // namespace

Farthest search_by_bounds(const SurfaceTree& source, const GroupSurface& group, std::span<const TreeSlot> places,
                          double margin, Farthest farthest) {
  BoundedSearch search(source, group, places, margin, farthest.to_beat());
  if (!search.is_much_work()) search.run();
  farthest.take(search.found());
  return farthest;
}

}  // namespace meshlode::build
