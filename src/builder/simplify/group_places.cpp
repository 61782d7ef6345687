// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/group_places.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "format/grid.h"

namespace meshlode::builder {

GroupPlaces::GroupPlaces(std::vector<Vec3i> positions)
    : grid_position_(std::move(positions)), position_(grid_position_.size()) {
  Vec3i low(0);
  Vec3i high(0);
  for (std::size_t v = 0; v < grid_position_.size(); ++v) {
    low = v == 0 ? grid_position_[v] : glm::min(low, grid_position_[v]);
    high = v == 0 ? grid_position_[v] : glm::max(high, grid_position_[v]);
  }
  center_ = (Vec3d(low) + Vec3d(high)) * 0.5;
  const Vec3i extent = high - low;
  scale_ = std::max(1.0, 0.5 * std::max({extent.x, extent.y, extent.z}));
  inverse_scale_ = 1.0 / scale_;
  for (std::size_t v = 0; v < position_.size(); ++v) position_[v] = to_frame(grid_position_[v]);
}

Vec3i GroupPlaces::to_grid(const Vec3d& p) const {
  const Vec3d q = p * scale_ + center_;
  Vec3i out;
  for (int k = 0; k < 3; ++k) {
    constexpr double kMost = format::kMaxGridCoordinate;
    out[k] = static_cast<int>(std::max(-kMost, std::min(kMost, std::floor(q[k] + 0.5))));  // in this order no NaN stays
  }
  return out;
}

}  // namespace meshlode::builder
