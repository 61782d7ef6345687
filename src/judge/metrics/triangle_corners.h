// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles by their corners, wherever they lie: those of a large source are looked up, not copied. Internal to the
// judge.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace meshlode::judge {

class TriangleCorners {
 public:
  using Corners = std::array<Vec3d, 3>;

  TriangleCorners(std::size_t count, std::function<Corners(std::size_t)> at) : count_(count), at_(std::move(at)) {}
  /// \pre `triangles` outlives this
  TriangleCorners(const std::vector<Corners>& triangles)
      : count_(triangles.size()), at_([&triangles](std::size_t i) { return triangles[i]; }) {}

  [[nodiscard]] std::size_t size() const { return count_; }
  /// Safe from several threads.
  [[nodiscard]] Corners operator[](std::size_t i) const { return at_(i); }

 private:
  std::size_t count_;
  std::function<Corners(std::size_t)> at_;
};

}  // namespace meshlode::judge
