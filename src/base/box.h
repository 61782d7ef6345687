// SPDX-License-Identifier: MIT
// A box along the axes, around what is added to it.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "base/vec.h"

namespace meshlode {

/// Around points; at first around none.
struct Box3d {
  Vec3d low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};

  void add(const Vec3d& point) {
    low = glm::min(low, point);
    high = glm::max(high, point);
  }
  void add(const Box3d& other) {
    low = glm::min(low, other.low);
    high = glm::max(high, other.high);
  }
  [[nodiscard]] bool is_empty() const { return low.x > high.x; }
  [[nodiscard]] std::array<Vec3d, 8> corners() const {
    std::array<Vec3d, 8> all;
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i] = {(i & 1U) != 0 ? high.x : low.x, (i & 2U) != 0 ? high.y : low.y, (i & 4U) != 0 ? high.z : low.z};
    }
    return all;
  }
  [[nodiscard]] Vec3d size() const { return high - low; }
  /// The first of equal ones.
  [[nodiscard]] int longest_axis() const {
    const Vec3d extent = size();
    return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  }
  /// Along each axis they are so near.
  [[nodiscard]] bool is_within(const Box3d& other, double distance) const {
    return glm::all(glm::lessThanEqual(low, other.high + distance)) &&
           glm::all(glm::lessThanEqual(other.low, high + distance));
  }
};

}  // namespace meshlode
