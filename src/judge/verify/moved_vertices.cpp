// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/verify/moved_vertices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/id_table.h"

namespace meshlode::judge {

namespace {

constexpr std::int32_t kNowhere = 2000000000;
constexpr std::int32_t kLargestCoordinate = (1 << 23) - 1;
/// Along some axis, in steps: from here on a narrow triangle is a needle.
constexpr std::int64_t kNeedleLength = 4;
/// Squared half diagonal of a cell, in steps.
constexpr double kReach2 = 0.75;

constexpr std::size_t kSlots = 65536;

auto tuple_of(const Vec3d& p) {
  return std::tuple(p.x, p.y, p.z);
}

bool is_long(const GridPoint& from, const GridPoint& to) {
  std::int64_t longest = 0;
  for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, std::abs(std::int64_t{to[i]} - from[i]));
  return longest >= kNeedleLength;
}

}  // namespace

GridPoint MovedVertices::nearest(const Vec3d& relative) const {
  GridPoint q{};
  for (int i = 0; i < 3; ++i) {
    const double rounded = std::floor(relative[i] / step_ + 0.5);
    q[static_cast<std::size_t>(i)] = std::fabs(rounded) <= 1e9 ? static_cast<std::int32_t>(rounded) : kNowhere;
  }
  return q;
}

GridPoint MovedVertices::point_at(const Vec3d& relative) const {
  const GridPoint at = nearest(relative);
  if (moved_.empty() || moved_from_[slot_of(at)] == 0) return at;
  const auto found = moved_.find(tuple_of(relative));
  return found == moved_.end() ? at : found->second;
}

std::size_t MovedVertices::slot_of(const GridPoint& point) {
  std::uint64_t hash = 0;
  for (const std::int32_t coordinate : point) hash = hash_word(hash, static_cast<std::uint32_t>(coordinate));
  return hash % kSlots;
}

GridPoint MovedVertices::point_of(const Vec3d& position) const {
  return point_at(relative(position));
}

std::vector<GridPoint> MovedVertices::points_beside(const TriangleCorners& triangles,
                                                    const std::vector<std::pair<Place, Place>>& needles) const {
  const auto make_set = [](std::vector<GridPoint>& points) {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
  };
  std::vector<GridPoint> beside;
  for (const auto& [first, unused] : needles) {
    const GridPoint at = nearest(std::make_from_tuple<Vec3d>(first));  // and that of the second
    for (std::size_t turn = 0; turn < 6; ++turn) {
      beside.push_back(at);
      beside.back()[turn % 3] += turn < 3 ? 1 : -1;
    }
  }
  make_set(beside);
  std::vector<GridPoint> taken;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Vec3d& corner : triangles[t]) {
      const GridPoint point = nearest(relative(corner));
      if (std::binary_search(beside.begin(), beside.end(), point)) taken.push_back(point);
    }
  }
  make_set(taken);
  return taken;
}

void MovedVertices::find(const TriangleCorners& triangles) {
  moved_.clear();
  moved_from_.assign(kSlots, 0);
  std::vector<std::pair<Place, Place>> narrow;  // ends of needles whose two corners are nearest to one point
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const TriangleCorners::Corners triangle = triangles[t];
    std::array<Vec3d, 3> corner;
    std::array<GridPoint, 3> point;
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = relative(triangle[k]);
      point[k] = nearest(corner[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const std::size_t tip = (k + 2) % 3;
      if (point[k] != point[next] || corner[k] == corner[next] || !is_long(point[k], point[tip])) continue;
      narrow.emplace_back(std::minmax({tuple_of(corner[k]), tuple_of(corner[next])}));
    }
  }
  if (narrow.empty()) return;
  std::sort(narrow.begin(), narrow.end());
  narrow.erase(std::unique(narrow.begin(), narrow.end()), narrow.end());
  // No vertex goes any farther: of two that have moved, none is where the other is.
  const std::vector<GridPoint> taken = points_beside(triangles, narrow);

  struct Move {
    double distance2;
    Place who;
    GridPoint to;
  };
  std::set<GridPoint> arrived;
  for (const auto& [first, second] : narrow) {
    const Vec3d a = std::make_from_tuple<Vec3d>(first);
    const Vec3d b = std::make_from_tuple<Vec3d>(second);
    const GridPoint from = point_at(a);
    if (from != point_at(b)) continue;  // one of them has moved already
    std::optional<Move> best;
    for (std::size_t turn = 0; turn < 6; ++turn) {  // the first corner's moves come first, along x, y, z
      const auto axis = static_cast<int>(turn % 3);
      const Vec3d& who = turn < 3 ? a : b;
      const Vec3d& other = turn < 3 ? b : a;
      const double side = who[axis] / step_ > from[turn % 3] ? 1.0 : -1.0;
      if (!((who[axis] - other[axis]) * side > 0.0)) continue;  // towards the other corner the needle would turn over
      GridPoint to = from;
      to[turn % 3] += side > 0.0 ? 1 : -1;
      const Vec3d away = who / step_ - Vec3d(to[0], to[1], to[2]);
      const double distance2 = glm::dot(away, away);
      if (!(distance2 <= kReach2) || std::abs(to[turn % 3]) > kLargestCoordinate) continue;
      if (std::binary_search(taken.begin(), taken.end(), to) || arrived.contains(to)) continue;
      if (!best || distance2 < best->distance2) best = Move{distance2, tuple_of(who), to};
    }
    if (!best) continue;
    moved_.emplace(best->who, best->to);
    moved_from_[slot_of(from)] = 1;
    arrived.insert(best->to);
  }
}

}  // namespace meshlode::judge
