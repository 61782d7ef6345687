// SPDX-License-Identifier: GPL-3.0-or-later
// The oriented border of triangles on integer positions, for tests (I6): +1 for an edge from a to b, -1 for b to a.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace meshlode::testing_support {

using Point = std::array<int, 3>;
using Chain = std::map<std::pair<Point, Point>, int>;  ///< key ordered (low, high); the sign is the direction

inline Point point(const Vec3i& q) {
  return {q.x, q.y, q.z};
}

inline void add_triangle(Chain& chain, const std::array<Point, 3>& corners) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Point& a = corners[k];
    const Point& b = corners[(k + 1) % 3];
    if (a == b) continue;
    const auto key = a < b ? std::pair(a, b) : std::pair(b, a);
    const auto at = chain.try_emplace(key, 0).first;
    at->second += a < b ? 1 : -1;
    if (at->second == 0) chain.erase(at);
  }
}

}  // namespace meshlode::testing_support
