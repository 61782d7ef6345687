// SPDX-License-Identifier: GPL-3.0-or-later
// Where the vertices of a group are: on the grid, as they are stored, and in a frame of doubles, as they are weighed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/vec.h"

namespace meshlode::builder {

/// The frame has its origin in the middle of the group's box, and half the box's longest side is 1 in it (or one unit
/// of the grid, where the group is smaller): quadrics of it lose no digits far from the origin of the grid. A vertex is
/// always on the grid, and its place in the frame is exactly that point.
class GroupPlaces {
 public:
  explicit GroupPlaces(std::vector<Vec3i> positions);

  [[nodiscard]] std::size_t size() const { return position_.size(); }
  /// In the frame.
  [[nodiscard]] const Vec3d& operator[](std::uint32_t vertex) const { return position_[vertex]; }
  [[nodiscard]] const Vec3i& on_grid(std::uint32_t vertex) const { return grid_position_[vertex]; }
  /// Grid units per unit of the frame.
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Vec3d to_frame(const Vec3i& q) const { return (Vec3d(q) - center_) * inverse_scale_; }
  /// The nearest point of the grid.
  [[nodiscard]] Vec3i to_grid(const Vec3d& p) const;
  void move(std::uint32_t vertex, const Vec3i& to) {
    grid_position_[vertex] = to;
    position_[vertex] = to_frame(to);
  }
  /// To the point of the grid nearest to p.
  void move(std::uint32_t vertex, const Vec3d& p) { move(vertex, to_grid(p)); }

 private:
  Vec3d center_{0.0};
  double scale_ = 1.0, inverse_scale_ = 1.0;
  std::vector<Vec3i> grid_position_;
  std::vector<Vec3d> position_;
};

}  // namespace meshlode::builder
