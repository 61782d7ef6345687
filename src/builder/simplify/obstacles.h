// SPDX-License-Identifier: GPL-3.0-or-later
// What stands in the way of collapses, and what of it is told of a group that missed its target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "builder/lod_dag.h"

namespace meshlode::builder {

/// The last two are none: the edge waits at another price, or has no triangle any more.
enum class Obstacle : std::uint8_t { kNone, kLocked, kFlips, kSeams, kTopology, kCrowded, kPutBack, kNoEdge };

class Obstacles {
 public:
  void add(Obstacle obstacle) { ++counts_[static_cast<std::size_t>(obstacle)]; }
  [[nodiscard]] std::uint64_t count(Obstacle obstacle) const { return counts_[static_cast<std::size_t>(obstacle)]; }

  /// The commonest, of a group of so many pieces.
  [[nodiscard]] StuckReason reason(std::size_t pieces, std::size_t target_triangles) const {
    struct Reason {
      std::uint64_t count;
      StuckReason reason;
    };
    // What is too crowded to be looked at is a matter of how triangles hang together.
    const std::array<Reason, 4> reasons{
        {{count(Obstacle::kLocked), StuckReason::kLocked},
         {count(Obstacle::kFlips), StuckReason::kFlips},
         {count(Obstacle::kSeams), StuckReason::kSeams},
         {count(Obstacle::kTopology) + count(Obstacle::kCrowded), StuckReason::kTopology}}};
    Reason largest = reasons[0];
    for (const Reason& other : reasons) {
      if (other.count > largest.count) largest = other;
    }
    // A piece keeps two triangles where it is closed: so many leave no room for the target, whatever refuses the last.
    if (largest.reason != StuckReason::kLocked && 2 * pieces > target_triangles) return StuckReason::kComponents;
    return largest.count == 0 ? StuckReason::kTooSmall : largest.reason;
  }

 private:
  std::array<std::uint64_t, 8> counts_{};
};

}  // namespace meshlode::builder
