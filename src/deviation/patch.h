// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive subdivision of triangles where a distance may be largest: whoever promises most is divided first, and what
// cannot raise the maximum is dropped. The promise is an estimate from the values of six points, not a bound: a bound
// (distances are 1-Lipschitz) would ask for pieces as small as the distance itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace meshlode {

struct Probe {
  double value = 0.0;       ///< distance of a point to the other side
  std::uint32_t place = 0;  ///< of the tree over the other side, near the point's nearest
};

/// A triangle with six points: its corners, and the middles of its edges (of the edge that starts at corner k).
struct Patch {
  std::array<Vec3d, 3> corner;
  std::array<Probe, 3> at_corner, at_middle;
  double estimate = 0.0;
  std::uint32_t owner = 0;  ///< the triangle that it is part of
  std::uint32_t order = 0;  ///< of creation: ties are decided by it

  // How far a patch may rise above its points, as a share of how much they differ. A parabola's top lies at most 1/3
  // above and the ridge of a crease 1/2, but a peak that is narrower than the points' spacing may be missed by all of
  // them: on a faceted rock one between an edge's end and its middle stood 0.6 above, and 1.15 times the maximum found.
  static constexpr double kRise = 1.0;

  /// `inside` is one more value of the patch.
  void set_estimate(double inside) {
    double low = inside, high = inside;
    for (std::size_t k = 0; k < 3; ++k) {
      low = std::min(low, std::min(at_corner[k].value, at_middle[k].value));
      high = std::max(high, std::max(at_corner[k].value, at_middle[k].value));
    }
    estimate = high + kRise * (high - low);
  }
  void set_estimate() { set_estimate(at_corner[0].value); }
  [[nodiscard]] Vec3d middle(std::size_t k) const { return (corner[k] + corner[(k + 1) % 3]) * 0.5; }
  [[nodiscard]] bool operator<(const Patch& other) const {
    return estimate != other.estimate ? estimate < other.estimate : order > other.order;
  }
};

/// Probes has measure(point, place, owner) -> Probe, and maximum(), the largest value measured so far.
template <class Probes>
class PatchQueue {
 public:
  explicit PatchQueue(Probes& probes) : probes_(probes) {}

  void add(const Patch& patch) {
    if (!(patch.estimate > kWorthwhile * probes_.maximum())) return;
    heap_.push_back(patch);
    heap_.back().order = order_++;
    std::push_heap(heap_.begin(), heap_.end());
  }

  /// Divides up to `budget` patches.
  void refine(std::size_t budget) {
    for (; budget > 0 && !heap_.empty(); --budget) {
      std::pop_heap(heap_.begin(), heap_.end());
      const Patch patch = heap_.back();
      heap_.pop_back();
      if (!(patch.estimate > kWorthwhile * probes_.maximum())) return;
      divide(patch);
    }
  }

 private:
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
      part.set_estimate();
      add(part);
    }
  }

  Probes& probes_;
  std::uint32_t order_ = 0;
  std::vector<Patch> heap_;
};

}  // namespace meshlode
