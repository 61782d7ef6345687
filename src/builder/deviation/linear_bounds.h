// SPDX-License-Identifier: GPL-3.0-or-later
// How far a part of a triangle is from a surface at most, by linear functions: the distance to one triangle of the
// surface is convex, so that between the corners of the part it is no more than what is linear there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/vec.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/tree_slot.h"

namespace meshlode::builder {

/// Triangles of the surface that bound a part.
constexpr std::size_t kMostBounds = 5;

/// Barycentric weights of a point of the part.
using CornerShares = std::array<double, 3>;

/// Linear functions in a triangle, by their values at its corners: each the distance to a triangle, or more.
struct LinearBounds {
  std::array<std::array<double, 3>, kMostBounds> at_corner;
  std::array<TreeSlot, kMostBounds> of;
  std::size_t count = 0;

  [[nodiscard]] bool has(TreeSlot slot) const {
    const auto end = of.begin() + static_cast<std::ptrdiff_t>(count);
    return std::find(of.begin(), end, slot) != end;
  }
  [[nodiscard]] double least_at(const CornerShares& w) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count; ++k) {
      least = std::min(least, w[0] * at_corner[k][0] + w[1] * at_corner[k][1] + w[2] * at_corner[k][2]);
    }
    return least;
  }
  [[nodiscard]] std::array<double, 3> difference(std::size_t a, std::size_t b) const {
    std::array<double, 3> d;
    for (std::size_t i = 0; i < 3; ++i) d[i] = at_corner[a][i] - at_corner[b][i];
    return d;
  }
};

struct Highest {
  double value = -1.0;
  CornerShares weight{};

  void take(const LinearBounds& bounds, const CornerShares& w) {
    const double value_there = bounds.least_at(w);
    if (value_there > value) *this = {value_there, w};
  }
};

/// Where two functions are equal on an edge.
inline void try_edges(const LinearBounds& bounds, const std::array<double, 3>& difference, Highest& best) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if ((difference[i] < 0.0) == (difference[j] < 0.0)) continue;
    CornerShares w{};
    w[i] = difference[j] / (difference[j] - difference[i]);
    w[j] = 1.0 - w[i];
    best.take(bounds, w);
  }
}

/// Where three are equal inside.
inline void try_inside(const LinearBounds& bounds, const std::array<double, 3>& d, const std::array<double, 3>& e,
                       Highest& best) {
  CornerShares w{d[1] * e[2] - d[2] * e[1], d[2] * e[0] - d[0] * e[2], d[0] * e[1] - d[1] * e[0]};
  const double sum = w[0] + w[1] + w[2];
  for (double& share : w) share /= sum;
  if (w[0] > 0.0 && w[1] > 0.0 && w[2] > 0.0) best.take(bounds, w);
}

/// Where the least of the functions is largest: at a corner, on an edge where two are equal, or inside where three are.
[[nodiscard]] inline Highest highest_of(const LinearBounds& bounds) {
  Highest best;
  best.take(bounds, {1.0, 0.0, 0.0});
  best.take(bounds, {0.0, 1.0, 0.0});
  best.take(bounds, {0.0, 0.0, 1.0});
  for (std::size_t a = 0; a < bounds.count; ++a) {
    for (std::size_t b = a + 1; b < bounds.count; ++b) {
      const std::array<double, 3> d = bounds.difference(a, b);
      try_edges(bounds, d, best);
      for (std::size_t c = b + 1; c < bounds.count; ++c) try_inside(bounds, d, bounds.difference(a, c), best);
    }
  }
  return best;
}

/// A convex piece of the part, by the shares of its corners: cut off by up to kMostBounds lines, and so with few
/// corners.
class PieceOfPart {
 public:
  PieceOfPart() : corner_{CornerShares{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}, count_(3) {}

  [[nodiscard]] bool is_empty() const { return count_ == 0; }
  /// Where the function, linear with these values at the part's corners, is largest.
  [[nodiscard]] double most(const std::array<double, 3>& at_corner) const {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count_; ++i) most = std::max(most, value(at_corner, corner_[i]));
    return most;
  }
  /// Keeps where it is not negative; all of it, where rounding has the border pass zero more than twice.
  void keep_where(const std::array<double, 3>& at_corner) {
    std::array<double, kMostCorners> height;
    for (std::size_t i = 0; i < count_; ++i) height[i] = value(at_corner, corner_[i]);
    const auto next_of = [&](std::size_t i) { return i + 1 == count_ ? 0 : i + 1; };
    const auto crosses = [&](std::size_t i) { return (height[i] >= 0.0) != (height[next_of(i)] >= 0.0); };
    std::size_t crossings = 0;
    for (std::size_t i = 0; i < count_; ++i) crossings += crosses(i) ? 1 : 0;
    if (crossings > 2) return;
    std::array<CornerShares, kMostCorners> kept;
    std::size_t kept_count = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      if (height[i] >= 0.0) kept[kept_count++] = corner_[i];
      if (!crosses(i)) continue;
      const std::size_t j = next_of(i);
      const double share = height[i] / (height[i] - height[j]);
      for (std::size_t k = 0; k < 3; ++k) kept[kept_count][k] = (1.0 - share) * corner_[i][k] + share * corner_[j][k];
      ++kept_count;
    }
    corner_ = kept;
    count_ = kept_count;
  }

 private:
  [[nodiscard]] static double value(const std::array<double, 3>& at_corner, const CornerShares& w) {
    return w[0] * at_corner[0] + w[1] * at_corner[1] + w[2] * at_corner[2];
  }

  static constexpr std::size_t kMostCorners = 3 + kMostBounds;  // each line adds one at most
  std::array<CornerShares, kMostCorners> corner_;
  std::size_t count_;
};

/// How far a point of the part can be from the surface if this triangle is nearest to it, or no farther by `tie`; 0:
/// there is none. The distance to the triangle is at least that to a plane in front of it, which is linear. Where this
/// is more than a bound, the triangle is not nearest.
[[nodiscard]] inline double most_where_nearest(const TriangleCorners& triangle, const std::array<Vec3d, 3>& part,
                                               const LinearBounds& bounds, double tie) {
  const Vec3d middle = (part[0] + part[1] + part[2]) / 3.0;
  const Vec3d away = middle - nearest_point(middle, triangle);
  const double length = glm::length(away);
  if (!(length > 0.0)) return std::numeric_limits<double>::infinity();
  const Vec3d direction = away / length;
  double plane = -std::numeric_limits<double>::infinity();
  for (const Vec3d& corner : triangle) plane = std::max(plane, glm::dot(direction, corner - middle));
  std::array<double, 3> least;
  for (std::size_t k = 0; k < 3; ++k) least[k] = glm::dot(direction, part[k] - middle) - plane - tie;
  PieceOfPart nearer;
  for (std::size_t b = 0; b < bounds.count && !nearer.is_empty(); ++b) {
    std::array<double, 3> difference;
    for (std::size_t k = 0; k < 3; ++k) difference[k] = bounds.at_corner[b][k] - least[k];
    nearer.keep_where(difference);
  }
  if (nearer.is_empty()) return 0.0;
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < bounds.count; ++b) most = std::min(most, nearer.most(bounds.at_corner[b]));
  return most;
}

}  // namespace meshlode::builder
