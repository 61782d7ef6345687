// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/seams.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace meshlode::judge {
namespace {

/// Equal numbers for equal positions.
std::vector<std::uint32_t> number_positions(const std::vector<Vec3d>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto ka = key(a), kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<std::uint32_t> numbers(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    numbers[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? numbers[order[i - 1]] : order[i];
  }
  return numbers;
}

struct Edge {
  std::uint32_t low, high;        ///< position numbers, low < high
  std::uint32_t at_low, at_high;  ///< vertices
  std::uint32_t triangle, corner;
};

}  // namespace

std::vector<std::uint8_t> find_seams(const Surface& surface, const std::vector<Vec3f>& values, float tolerance) {
  const std::vector<std::uint32_t> numbers = number_positions(surface.positions);
  std::vector<Edge> edges;
  edges.reserve(3 * surface.triangles.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      if (numbers[a] == numbers[b]) continue;
      if (numbers[a] < numbers[b]) {
        edges.push_back({numbers[a], numbers[b], a, b, t, k});
      } else {
        edges.push_back({numbers[b], numbers[a], b, a, t, k});
      }
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.low, x.high, x.triangle, x.corner) < std::tie(y.low, y.high, y.triangle, y.corner);
  });
  const auto differs = [&](std::uint32_t x, std::uint32_t y) {
    return x != y && !(glm::length(values[x] - values[y]) <= tolerance);  // unknown values differ from all
  };
  std::vector<std::uint8_t> seams(surface.triangles.size(), 0);
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t last = first;
    bool is_seam = false;
    while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high) {
      is_seam = is_seam || differs(edges[last].at_low, edges[first].at_low) ||
                differs(edges[last].at_high, edges[first].at_high);
      ++last;
    }
    for (std::size_t e = first; is_seam && e < last; ++e) {
      seams[edges[e].triangle] = static_cast<std::uint8_t>(seams[edges[e].triangle] | (1U << edges[e].corner));
    }
    first = last;
  }
  return seams;
}

}  // namespace meshlode::judge
