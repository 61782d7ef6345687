// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/aggregate/blocks.h"

#include <algorithm>
#include <numeric>

namespace meshlode::build {

namespace {

using Run = std::span<std::uint32_t>;

/// Along the longest side of the box around the points; equal ones by number.
void sort_along(std::span<const Vec3d> points, Run run) {
  if (run.empty()) return;
  Vec3d low = points[run.front()], high = low;
  for (const std::uint32_t i : run) {
    low = glm::min(low, points[i]);
    high = glm::max(high, points[i]);
  }
  const Vec3d size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
  std::sort(run.begin(), run.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points[a][axis] != points[b][axis] ? points[a][axis] < points[b][axis] : a < b;
  });
}

void split_run(std::span<const Vec3d> points, Run run, std::size_t count, std::uint32_t begin, Blocks& blocks) {
  if (count == 1) {
    blocks.first.push_back(begin + static_cast<std::uint32_t>(run.size()));
    return;
  }
  sort_along(points, run);
  const std::size_t half = count / 2;
  const std::size_t middle = (run.size() * half + count / 2) / count;
  const std::size_t cut = std::clamp(middle, half, run.size() - (count - half));
  split_run(points, run.first(cut), half, begin, blocks);
  split_run(points, run.subspan(cut), count - half, begin + static_cast<std::uint32_t>(cut), blocks);
}

void split_run_by_weight(std::span<const Vec3d> points, std::span<const std::uint32_t> weights, Run run, int depth,
                         std::uint32_t begin, Blocks& blocks) {
  if (depth == 0) {
    blocks.first.push_back(begin + static_cast<std::uint32_t>(run.size()));
    return;
  }
  sort_along(points, run);
  std::uint64_t total = 0;
  for (const std::uint32_t i : run) total += weights[i];
  std::size_t cut = 0;
  for (std::uint64_t sum = 0; cut < run.size() && 2 * sum + weights[run[cut]] <= total; ++cut) sum += weights[run[cut]];
  split_run_by_weight(points, weights, run.first(cut), depth - 1, begin, blocks);
  split_run_by_weight(points, weights, run.subspan(cut), depth - 1, begin + static_cast<std::uint32_t>(cut), blocks);
}

Blocks all_of(std::size_t points) {
  Blocks blocks;
  blocks.order.resize(points);
  std::iota(blocks.order.begin(), blocks.order.end(), 0U);
  blocks.first.push_back(0);
  return blocks;
}

}  // namespace

Blocks split_evenly(std::span<const Vec3d> points, std::size_t count) {
  Blocks blocks = all_of(points.size());
  split_run(points, blocks.order, count, 0, blocks);
  return blocks;
}

Blocks split_by_weight(std::span<const Vec3d> points, std::span<const std::uint32_t> weights, int depth) {
  Blocks blocks = all_of(points.size());
  split_run_by_weight(points, weights, blocks.order, depth, 0, blocks);
  return blocks;
}

}  // namespace meshlode::build
