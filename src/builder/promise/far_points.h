// SPDX-License-Identifier: GPL-3.0-or-later
// The farthest points of a surface so far, and the search for farther ones on their triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "base/random.h"
#include "builder/promise/product_tree.h"

namespace meshlode::builder {

/// A point of a surface from which a farther one may be looked for.
struct FarPoint {
  double distance2;
  std::uint32_t triangle;
  double b, c;
  std::uint32_t place;  ///< the nearest triangle of the other surface
};

/// The farthest so far, at most one of a triangle.
class FarPoints {
 public:
  void add(const FarPoint& far) {
    for (FarPoint& known : list_) {
      if (known.triangle != far.triangle) continue;
      if (far.distance2 > known.distance2) known = far;
      return;
    }
    if (list_.size() < kMost) {
      list_.push_back(far);
      return;
    }
    const auto least = std::min_element(list_.begin(), list_.end(),
                                        [](const FarPoint& a, const FarPoint& b) { return a.distance2 < b.distance2; });
    if (far.distance2 > least->distance2) *least = far;
  }
  [[nodiscard]] const std::vector<FarPoint>& list() const { return list_; }

 private:
  static constexpr std::size_t kMost = 64;
  std::vector<FarPoint> list_;
};

/// Inside of the triangle, or on an edge of it: a needle is nothing but edges.
inline std::array<double, 2> random_weights(SplitMix64& random) {
  double b = random.unit(), c = random.unit();
  switch (random.below(6)) {
    case 0: return {b, 0.0};
    case 1: return {0.0, c};
    case 2: return {b, 1.0 - b};
    default: break;
  }
  if (b + c > 1.0) {
    b = 1.0 - b;
    c = 1.0 - c;
  }
  return {b, c};
}

/// Along the edges of a triangle, in weights of its second and third corner.
inline constexpr std::array<std::array<double, 2>, 6> kDirections{
    {{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}, {1.0, -1.0}, {-1.0, 1.0}}};

/// Looks for a farther point on the same triangle of `surface`: on a lattice, and around its best point ever closer.
template <std::size_t D>
void climb(const ProductSurface<D>& surface, const ProductTree<D>& other, FarPoint& far) {
  const auto look = [&](double b, double c) {
    if (b < 0.0 || c < 0.0 || b + c > 1.0) return;
    const auto hit = other.find(surface.at(far.triangle, b, c), far.place, far.distance2);
    if (hit.triangle == kNoId || hit.distance2 <= far.distance2) return;
    far = {hit.distance2, far.triangle, b, c, hit.triangle};
  };
  constexpr int kLattice = 6, kSteps = 5;
  constexpr double kSpacing = 1.0 / kLattice;
  for (int i = 0; i <= kLattice; ++i) {
    for (int k = 0; i + k <= kLattice; ++k) look(i * kSpacing, std::min(k * kSpacing, 1.0 - i * kSpacing));
  }
  double length = 0.5 * kSpacing;
  for (int step = 0; step < kSteps; ++step, length *= 0.5) {
    const FarPoint from = far;
    for (const auto& [b, c] : kDirections) look(from.b + length * b, from.c + length * c);
  }
}

/// The same near the point itself, at random: what lies elsewhere on a triangle of the source may be another group's.
template <std::size_t D>
void climb_near(const ProductSurface<D>& surface, const ProductTree<D>& other, FarPoint& far) {
  constexpr int kNearSteps = 7, kNearTries = 10;
  SplitMix64 random(0x66726F6DULL + far.triangle);
  double length = 1.0;
  for (int step = 0; step < kNearSteps; ++step, length *= 0.5) {
    for (int i = 0; i < kNearTries; ++i) {
      const auto [b, c] = random_weights(random);
      const double tried_b = far.b + length * (b - far.b), tried_c = far.c + length * (c - far.c);
      const auto hit = other.find(surface.at(far.triangle, tried_b, tried_c), far.place, far.distance2);
      if (hit.triangle == kNoId || hit.distance2 <= far.distance2) continue;
      far = {hit.distance2, far.triangle, tried_b, tried_c, hit.triangle};
    }
  }
}

}  // namespace meshlode::builder
