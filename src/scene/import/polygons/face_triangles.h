// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon of three dimensions becomes triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/scene.h"

namespace meshlode::scene {

class FaceTriangles {
 public:
  explicit FaceTriangles(const std::vector<Vec3d>& positions) : positions_(positions) {}
  /// Appends triangles to `indices`: polygon.size() - 2 where no corner lies on another or on a side.
  /// \pre three corners or more, whose positions are finite
  void append(std::span<const std::uint32_t> polygon, std::vector<std::uint32_t>& indices);
  /// Says what could not be done as it should.
  void report(std::vector<LeftOut>& left_out) const;

 private:
  bool append_triangulated(std::span<const std::uint32_t> polygon, const Vec3d& area,
                           std::vector<std::uint32_t>& indices);
  const std::vector<Vec3d>& positions_;
  std::uint64_t work_ = 0;  ///< squares of the corners of large polygons so far
  std::uint64_t crossing_ = 0, too_large_ = 0;
};

}  // namespace meshlode::scene
