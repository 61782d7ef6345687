// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/aggregate/blocks.h"

#include <algorithm>
#include <numeric>

#include "base/box.h"

namespace meshlode::builder {

namespace {

using Run = std::span<std::uint32_t>;

/// Along the longest side of the box around the points; equal ones by number.
class Along {
 public:
  /// \pre there are some
  Along(std::span<const Vec3d> points, Run run) : points_(points) {
    Box3d box;
    for (const std::uint32_t i : run) box.add(points[i]);
    axis_ = box.longest_axis();
  }
  [[nodiscard]] bool operator()(std::uint32_t a, std::uint32_t b) const {
    const double x = points_[a][axis_], y = points_[b][axis_];
    return x != y ? x < y : a < b;
  }

 private:
  std::span<const Vec3d> points_;
  int axis_ = 0;
};

void split_run(std::span<const Vec3d> points, Run run, std::size_t count, std::uint32_t begin, Blocks& blocks) {
  if (count == 1) {
    blocks.first.push_back(begin + static_cast<std::uint32_t>(run.size()));
    return;
  }
  const std::size_t half = count / 2;
  const std::size_t middle = (run.size() * half + count / 2) / count;
  const std::size_t cut = std::clamp(middle, half, run.size() - (count - half));
  if (!run.empty()) {
    const auto at = run.begin() + static_cast<std::ptrdiff_t>(cut);
    const Along along(points, run);
    std::nth_element(run.begin(), at, run.end(), along);
    // What is split again is put in order there.
    if (half == 1) std::sort(run.begin(), at, along);
    if (count - half == 1) std::sort(at, run.end(), along);
  }
  split_run(points, run.first(cut), half, begin, blocks);
  split_run(points, run.subspan(cut), count - half, begin + static_cast<std::uint32_t>(cut), blocks);
}

void split_run_by_weight(std::span<const Vec3d> points, std::span<const std::uint32_t> weights, Run run, int depth,
                         std::uint32_t begin, Blocks& blocks) {
  if (depth == 0) {
    blocks.first.push_back(begin + static_cast<std::uint32_t>(run.size()));
    return;
  }
  if (!run.empty()) std::sort(run.begin(), run.end(), Along(points, run));
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

}  // namespace meshlode::builder
