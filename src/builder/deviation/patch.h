// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive subdivision of triangles where a distance may be largest: whoever promises most is divided first, and what
// cannot raise the maximum is dropped. The promise is an estimate from the values of six points, not a bound: a bound
// (distances are 1-Lipschitz) asks for pieces as small as the distance itself. What is left of the effort goes where
// the bound is largest all the same: on soups, needles and cards peaks are narrow, and no point near one tells of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/vec.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surface_tree.h"

namespace meshlode::builder {

struct Probe {
  double value = 0.0;  ///< distance of a point to the other side
  TreeSlot place{0U};  ///< of the tree over the other side, near the point's nearest
};

/// How far a patch may rise above its points, as a share of how much they differ. The effort goes first where the first
/// of the two promises more than is known, and what is left of it where the last does.
struct Rise {
  double first = 1.0, last = 1.0;
};
// A parabola's top lies at most 1/3 above and the ridge of a crease 1/2, but a peak that is narrower than the points'
// spacing may be missed by all of them: on a faceted rock one between an edge's end and its middle stood 0.6 above, and
// 1.15 times the maximum found; beside the risers of terraces several stood more than 1.0 above.
constexpr Rise kHighestRise{1.0, 2.0};
// Where a group has many small triangles effort is short, and goes farther when it is spent on what is likely: with 0.6
// and a quarter of the effort the maxima of the dragon's groups are the same in the mean as with 1.0, and of 1% of them
// more than 1.2% lower. On terraces hardly any of it is spent so, and peaks are missed that 1.0 finds.
constexpr Rise kUsualRise{0.6, 1.0};

/// A triangle with six points: its corners, and the middles of its edges (of the edge that starts at corner k).
struct Patch {
  std::array<Vec3d, 3> corner;
  std::array<Probe, 3> at_corner, at_middle;
  double highest = 0.0, range = 0.0;                         ///< of its values
  double ceiling = std::numeric_limits<double>::infinity();  ///< no point of it is farther, where it is bounded
  double estimate = 0.0;
  std::uint32_t owner = 0;  ///< the triangle that it is part of

  [[nodiscard]] bool is_bounded() const { return ceiling < std::numeric_limits<double>::infinity(); }
  /// `inside` is one more value of the patch.
  void set_range(double inside) {
    double low = inside;
    highest = inside;
    for (std::size_t k = 0; k < 3; ++k) {
      low = std::min(low, std::min(at_corner[k].value, at_middle[k].value));
      highest = std::max(highest, std::max(at_corner[k].value, at_middle[k].value));
    }
    range = highest - low;
  }
  [[nodiscard]] double promise(double rise) const { return std::min(highest + rise * range, ceiling); }
  /// No point of the patch is farther than this. The six points are the corners of four triangles, and no point of a
  /// triangle is farther from the nearest corner than 1 / sqrt(3) of the longest edge.
  [[nodiscard]] double bound() const {
    double longest2 = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d edge = corner[(k + 1) % 3] - corner[k];
      longest2 = std::max(longest2, glm::dot(edge, edge));
    }
    return highest + 0.5 * 0.57735026918962584 * std::sqrt(longest2);
  }
  [[nodiscard]] Vec3d middle(std::size_t k) const { return (corner[k] + corner[(k + 1) % 3]) * 0.5; }
};

/// A patch in a heap, which moves these instead of some hundred bytes.
struct RankedPatch {
  double estimate = 0.0;
  std::uint32_t order = 0;  ///< of creation: ties are decided by it
  std::uint32_t patch = 0;  ///< its place among the patches of the queue
  [[nodiscard]] bool operator<(const RankedPatch& other) const {
    return estimate != other.estimate ? estimate < other.estimate : order > other.order;
  }
};

/// The distance to a triangle is convex, so that no point of a patch is farther from it than a corner is: of the
/// triangles of the other side that are near the six points, the one that is best for all three corners bounds the
/// patch. A bound of no more than `enough` is as good as a lower one.
[[nodiscard]] inline double bound_by_one_triangle(const SurfaceTree& other, const Patch& patch, double enough) {
  double best2 = std::numeric_limits<double>::infinity();
  const double enough2 = enough * enough;
  std::array<TreeSlot, 6> tried;
  std::size_t count = 0;
  for (std::size_t k = 0; k < 6 && best2 > enough2; ++k) {
    const TreeSlot place = k < 3 ? patch.at_corner[k].place : patch.at_middle[k - 3].place;
    if (std::find(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(count), place) !=
        tried.begin() + static_cast<std::ptrdiff_t>(count)) {
      continue;
    }
    tried[count++] = place;
    const TriangleDistance triangle(other.corners_at(place));
    double farthest2 = 0.0;
    for (std::size_t j = 0; j < 3 && farthest2 < best2; ++j) {
      farthest2 = std::max(farthest2, triangle.squared_to(patch.corner[j]));
    }
    best2 = std::min(best2, farthest2);
  }
  return std::sqrt(best2);
}

/// Probes has measure(point, place, owner) -> Probe, maximum(), the largest value measured so far, and tree(), over the
/// other side.
template <class Probes>
class PatchQueue {
 public:
  PatchQueue(Probes& probes, Rise rise, std::size_t spare)
      : probes_(probes), rise_(rise.first), last_rise_(rise.last), spare_(spare) {}

  /// \pre set_range()
  void add(Patch patch) {
    patch.estimate = patch.promise(rise_);
    if (is_worthwhile(patch.estimate)) {
      push(heap_, patch);
    } else {
      put_off(patch);
    }
  }

  /// Divides up to `budget` patches by their estimates, and those set aside by their bounds as far as the spare effort
  /// goes.
  void refine(std::size_t budget) {
    while (true) {
      if (budget > 0 && !heap_.empty()) {
        Patch patch = pop(heap_);
        if (!is_worthwhile(patch.estimate)) {
          put_off(patch);
        } else if (patch.is_bounded()) {
          --budget;
          divide(patch);
        } else if (bound(patch)) {
          push(heap_, patch);  // behind those that promise more than its bound
        }
      } else if (!late_.empty() && (budget > 0 || spare_ > 0)) {
        rise_ = last_rise_;
        std::vector<Patch> late;
        late.swap(late_);
        for (const Patch& patch : late) {
          if (budget > 0) {
            add(patch);
          } else {
            set_aside(patch);
          }
        }
      } else if (spare_ > 0 && !aside_.empty()) {
        const Patch patch = pop(aside_);
        if (!is_worthwhile(patch.estimate)) return;
        --spare_;
        divide(patch);
      } else {
        return;
      }
    }
  }

 private:
  [[nodiscard]] bool is_worthwhile(double value) const { return value > kWorthwhile * probes_.maximum(); }
  void push(std::vector<RankedPatch>& heap, const Patch& patch) {
    auto at = static_cast<std::uint32_t>(patches_.size());
    if (free_.empty()) {
      patches_.push_back(patch);
    } else {
      at = free_.back();
      free_.pop_back();
      patches_[at] = patch;
    }
    heap.push_back({patch.estimate, order_++, at});
    std::push_heap(heap.begin(), heap.end());
  }
  Patch pop(std::vector<RankedPatch>& heap) {
    std::pop_heap(heap.begin(), heap.end());
    const std::uint32_t at = heap.back().patch;
    heap.pop_back();
    free_.push_back(at);
    return patches_[at];
  }
  /// Lowers the estimate to what is possible at all. False where that is not worthwhile.
  bool bound(Patch& patch) {
    patch.ceiling = patch.bound();
    if (is_worthwhile(patch.ceiling)) {
      const double enough = kWorthwhile * probes_.maximum();
      patch.ceiling = std::min(patch.ceiling, bound_by_one_triangle(probes_.tree(), patch, enough));
    }
    patch.estimate = std::min(patch.estimate, patch.ceiling);
    return is_worthwhile(patch.ceiling);
  }
  /// What does not promise enough.
  void put_off(const Patch& patch) {
    if (rise_ < last_rise_ && is_worthwhile(patch.promise(last_rise_))) {
      late_.push_back(patch);
    } else if (spare_ > 0) {
      set_aside(patch);
    }
  }
  void set_aside(Patch patch) {
    patch.estimate = std::numeric_limits<double>::infinity();
    if (bound(patch)) push(aside_, patch);
  }

  // A patch that cannot raise the maximum by more than this is left alone.
  static constexpr double kWorthwhile = 1.002;

  /// Into four, with nine new points.
  void divide(const Patch& patch) {
    std::array<Vec3d, 3> middle;
    for (std::size_t k = 0; k < 3; ++k) middle[k] = patch.middle(k);
    std::array<Patch, 4> parts;
    for (std::size_t k = 0; k < 3; ++k) {  // at corner k: the corner, the middle after it, the middle before it
      const std::size_t before = (k + 2) % 3;
      parts[k].corner = {patch.corner[k], middle[k], middle[before]};
      parts[k].at_corner = {patch.at_corner[k], patch.at_middle[k], patch.at_middle[before]};
      for (std::size_t j = 0; j < 3; ++j) {
        parts[k].at_middle[j] = probes_.measure(parts[k].middle(j), parts[k].at_corner[j].place, patch.owner);
      }
    }
    parts[3].corner = middle;
    parts[3].at_corner = patch.at_middle;
    // The middle part's edge from middle k to middle k+1 is the inner edge of the part at corner k+1.
    for (std::size_t k = 0; k < 3; ++k) parts[3].at_middle[k] = parts[(k + 1) % 3].at_middle[1];
    for (Patch& part : parts) {
      part.owner = patch.owner;
      part.set_range(part.at_corner[0].value);
      add(part);
    }
  }

  Probes& probes_;
  double rise_, last_rise_;
  std::size_t spare_;  ///< patches that may be divided although they promise nothing
  std::uint32_t order_ = 0;
  std::vector<Patch> patches_;       ///< of both heaps, and places of those that left them
  std::vector<std::uint32_t> free_;  ///< such places
  std::vector<RankedPatch> heap_;
  std::vector<Patch> late_;         ///< worthwhile by the last rise only
  std::vector<RankedPatch> aside_;  ///< by their bounds
};

}  // namespace meshlode::builder
