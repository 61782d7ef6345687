// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/prepare/separate_needles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <set>
#include <tuple>

namespace meshlode::build {

namespace {

/// Shorter ones lose less than a few steps, which is what the grid costs anyway.
constexpr int kShortest = 4;
/// Squared half diagonal of a cell: how far the grid may move a vertex, in steps.
constexpr double kFarthest2 = 0.75;

auto tuple_of(const Vec3i& q) {
  return std::tuple(q.x, q.y, q.z);
}
auto tuple_of(const Vec3d& p) {
  return std::tuple(p.x, p.y, p.z);
}

/// Corners a and b share a cell; the tip is elsewhere.
struct Needle {
  std::uint32_t a, b, tip;  ///< a before b by position
};

std::vector<Needle> find_needles(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                                 const std::vector<Vec3i>& cells) {
  std::vector<Needle> needles;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      Needle needle{triangles[t + k], triangles[t + (k + 1) % 3], triangles[t + (k + 2) % 3]};
      if (cells[needle.a] != cells[needle.b] || positions[needle.a] == positions[needle.b]) continue;
      const Vec3i along = cells[needle.tip] - cells[needle.a];
      if (std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)}) < kShortest) continue;
      if (tuple_of(positions[needle.b]) < tuple_of(positions[needle.a])) std::swap(needle.a, needle.b);
      needles.push_back(needle);
    }
  }
  std::sort(needles.begin(), needles.end(), [&](const Needle& x, const Needle& y) {
    return std::tuple(tuple_of(positions[x.a]), tuple_of(positions[x.b]), tuple_of(positions[x.tip])) <
           std::tuple(tuple_of(positions[y.a]), tuple_of(positions[y.b]), tuple_of(positions[y.tip]));
  });
  return needles;
}

}  // namespace

std::uint64_t separate_needles(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                               const format::PositionGrid& grid, std::vector<Vec3i>& cells) {
  const std::vector<Needle> needles = find_needles(positions, triangles, cells);
  if (needles.empty()) return 0;

  // Vertices of equal position move together; a cell is free where no triangle's vertex lies.
  std::vector<std::uint32_t> by_position(triangles.begin(), triangles.end());
  std::sort(by_position.begin(), by_position.end());
  by_position.erase(std::unique(by_position.begin(), by_position.end()), by_position.end());
  std::vector<std::tuple<int, int, int>> occupied;
  occupied.reserve(by_position.size());
  for (const std::uint32_t v : by_position) occupied.push_back(tuple_of(cells[v]));
  std::sort(occupied.begin(), occupied.end());
  std::set<std::tuple<int, int, int>> taken;  // since
  const auto before = [&](std::uint32_t x, std::uint32_t y) { return tuple_of(positions[x]) < tuple_of(positions[y]); };
  std::sort(by_position.begin(), by_position.end(), before);

  const double step = grid.step();
  std::uint64_t kept = 0;
  for (const Needle& needle : needles) {
    if (cells[needle.a] != cells[needle.b]) {
      ++kept;  // a neighbour has moved it
      continue;
    }
    std::uint32_t best = needle.a;
    Vec3i best_cell(0);
    double best_distance2 = kFarthest2;
    bool is_found = false;
    for (const std::uint32_t v : {needle.a, needle.b}) {
      const std::uint32_t other = v == needle.a ? needle.b : needle.a;
      const Vec3d residual = positions[v] / step - Vec3d(cells[v]);
      for (int axis = 0; axis < 3; ++axis) {
        const int side = residual[axis] > 0.0 ? 1 : -1;
        // Away from the other corner, or the needle would turn over.
        if (!((positions[v][axis] - positions[other][axis]) * side > 0.0)) continue;
        Vec3i cell = cells[v];
        cell[axis] += side;
        if (std::abs(cell[axis]) > format::kMaxGridCoordinate) continue;
        const Vec3d left = positions[v] / step - Vec3d(cell);
        const double distance2 = glm::dot(left, left);
        if (distance2 > best_distance2 || (is_found && distance2 == best_distance2)) continue;
        if (std::binary_search(occupied.begin(), occupied.end(), tuple_of(cell)) || taken.contains(tuple_of(cell)))
          continue;
        best = v;
        best_cell = cell;
        best_distance2 = distance2;
        is_found = true;
      }
    }
    if (!is_found) continue;
    ++kept;
    const auto [first, last] = std::equal_range(by_position.begin(), by_position.end(), best, before);
    for (auto v = first; v != last; ++v) cells[*v] = best_cell;
    taken.insert(tuple_of(best_cell));
  }
  return kept;
}

}  // namespace meshlode::build
