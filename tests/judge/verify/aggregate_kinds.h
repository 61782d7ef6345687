// SPDX-License-Identifier: GPL-3.0-or-later
// Aggregates of kinds that the generator's samples are not: thin walls, flat fields, clumps, single triangles.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>

#include "base/random.h"
#include "scene/samples/samples.h"

namespace meshlode::test {

class AggregateMaker {
 public:
  explicit AggregateMaker(std::uint64_t seed) : random_(seed) {}

  [[nodiscard]] double between(double low, double high) { return random_.between(low, high); }
  [[nodiscard]] Vec3d direction() {
    while (true) {
      const Vec3d v{between(-1, 1), between(-1, 1), between(-1, 1)};  // in this order, with any compiler
      const double length = glm::length(v);
      if (length > 0.1 && length < 1.0) return v / length;
    }
  }
  void add_card(const Vec3d& center, const Vec3d& normal, double half_u, double half_v) {
    const Vec3d u = glm::normalize(glm::cross(normal, direction())), v = glm::cross(normal, u);
    const std::uint32_t first = add_corners({center - u * half_u - v * half_v, center + u * half_u - v * half_v,
                                             center + u * half_u + v * half_v, center - u * half_u + v * half_v});
    shape_.indices.insert(shape_.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }
  void add_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const std::uint32_t first = add_corners({a, b, c});
    shape_.indices.insert(shape_.indices.end(), {first, first + 1, first + 2});
  }
  [[nodiscard]] scene::Primitive take() { return std::move(shape_); }

 private:
  std::uint32_t add_corners(std::initializer_list<Vec3d> corners) {
    const auto first = static_cast<std::uint32_t>(shape_.positions.size());
    shape_.positions.insert(shape_.positions.end(), corners);
    return first;
  }

  SplitMix64 random_;
  scene::Primitive shape_;
};

inline constexpr std::array kAggregateKinds{"hedge",   "ivy",    "pads",      "clumps",
                                            "conifer", "blades", "splinters", "fence"};

/// `count` pieces of a kind.
inline scene::Primitive make_aggregate(const std::string& kind, std::uint32_t count, std::uint64_t seed) {
  AggregateMaker make(seed);
  Vec3d clump(0.0);
  for (std::uint32_t i = 0; i < count; ++i) {
    // One number after the other: arguments of a call are worked out in any order.
    const Vec3d at{make.between(-1, 1), make.between(-1, 1), make.between(-1, 1)};
    const Vec3d one = make.direction(), other = make.direction();
    const Vec3d around = glm::normalize(one * Vec3d(1, 0, 1) + Vec3d(1e-6, 0, 0));
    if (kind == "hedge") {
      make.add_card(at * Vec3d(5, 0.5, 0.4), one, 0.08, 0.08);
    } else if (kind == "ivy") {
      make.add_card(at * Vec3d(2, 2, 0.05), glm::normalize(0.4 * one + Vec3d(0, 0.2, 1)), 0.06, 0.06);
    } else if (kind == "pads") {
      make.add_card(at * Vec3d(3, 0.05, 3), glm::normalize(0.1 * one + Vec3d(0, 1, 0)), 0.08, 0.08);
    } else if (kind == "clumps") {
      if (i % 100 == 0) clump = other;
      make.add_card(clump + 0.15 * at, one, 0.03, 0.03);
    } else if (kind == "conifer") {
      const double height = 0.5 + 0.5 * at.y;
      make.add_card(around * (0.6 * (1.0 - height) * std::abs(at.x)) + Vec3d(0, 2.0 * height, 0), other, 0.06, 0.008);
    } else if (kind == "blades") {
      const Vec3d foot = at * Vec3d(2, 0, 2), side = 0.02 * around;
      make.add_triangle(foot - side, foot + side, foot + Vec3d(0, 0.2 + 0.1 * at.y, 0) + 2.0 * side);
    } else if (kind == "splinters") {
      make.add_triangle(at, at + 0.06 * one, at + 0.06 * other);
    } else {  // fence: cards that stand
      make.add_card(at * Vec3d(3, 0, 3), around, 0.05, 0.2);
    }
  }
  return make.take();
}

}  // namespace meshlode::test
