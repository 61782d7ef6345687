// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/moved_vertices.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace meshlode {

namespace {

constexpr std::int32_t kNowhere = 2000000000;
/// In which forced moves may force others: enough for real chains, few enough for a source that is not the asset's.
constexpr int kRounds = 32;

auto tuple_of(const Vec3d& p) { return std::tuple(p.x, p.y, p.z); }

}  // namespace

GridPoint MovedVertices::nearest(const Vec3d& position) const {
  GridPoint q{};
  for (int i = 0; i < 3; ++i) {
    const double rounded = std::floor((position[i] + 0.0 - origin_[i]) / step_ + 0.5);
    q[static_cast<std::size_t>(i)] = std::fabs(rounded) <= 1e9 ? static_cast<std::int32_t>(rounded) : kNowhere;
  }
  return q;
}

GridPoint MovedVertices::point_of(const Vec3d& position) const {
  if (!moved_.empty()) {
    const auto found = moved_.find(tuple_of(position + 0.0));
    if (found != moved_.end()) return found->second;
  }
  return nearest(position);
}

std::vector<GridPoint> MovedVertices::choices(const Vec3d& position) const {
  if (const auto found = moved_.find(tuple_of(position + 0.0)); found != moved_.end()) return {found->second};
  const GridPoint q = nearest(position);
  std::vector<GridPoint> out{q};
  if (std::find(q.begin(), q.end(), kNowhere) != q.end() || !may_move_.contains(tuple_of(position + 0.0))) return out;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      GridPoint next = q;
      next[static_cast<std::size_t>(axis)] += side;
      const Vec3d away = (position - origin_) / step_ - Vec3d(next[0], next[1], next[2]);
      if (glm::dot(away, away) <= 0.75 * (1.0 + 1e-9)) out.push_back(next);
    }
  }
  return out;
}

void MovedVertices::find(std::span<const MissingTriangle> missing, std::span<const TriangleKey> unmatched) {
  for (const MissingTriangle& triangle : missing) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& a = triangle.corner[k];
      const Vec3d& b = triangle.corner[(k + 1) % 3];
      if (a == b || nearest(a) != nearest(b)) continue;
      may_move_.insert(tuple_of(a + 0.0));
      may_move_.insert(tuple_of(b + 0.0));
    }
  }
  const auto fits = [&](const MissingTriangle& triangle) {
    std::vector<GridCorners> out;
    const std::array<std::vector<GridPoint>, 3> at{choices(triangle.corner[0]), choices(triangle.corner[1]),
                                                   choices(triangle.corner[2])};
    for (const GridPoint& a : at[0]) {
      for (const GridPoint& b : at[1]) {
        for (const GridPoint& c : at[2]) {
          if (std::binary_search(unmatched.begin(), unmatched.end(),
                                 TriangleKey{triangle.material, rotate_to_smallest({a, b, c})})) {
            out.push_back({a, b, c});
          }
        }
      }
    }
    return out;
  };
  const auto bind = [&](const MissingTriangle& triangle, const GridCorners& corners) {
    for (std::size_t k = 0; k < 3; ++k) moved_.try_emplace(tuple_of(triangle.corner[k] + 0.0), corners[k]);
  };
  std::vector<std::size_t> open(missing.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (int round = 0; round < kRounds && !open.empty(); ++round) {
    std::vector<std::size_t> rest;
    for (const std::size_t i : open) {
      const std::vector<GridCorners> found = fits(missing[i]);
      if (found.size() == 1) bind(missing[i], found[0]);
      if (found.size() > 1) rest.push_back(i);
    }
    if (rest.size() == open.size()) break;
    open = std::move(rest);
  }
  for (const std::size_t i : open) {  // nothing forces anything any more: the first choice, and see
    const std::vector<GridCorners> found = fits(missing[i]);
    if (!found.empty()) bind(missing[i], found[0]);
  }
}

}  // namespace meshlode
