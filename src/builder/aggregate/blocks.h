// SPDX-License-Identifier: GPL-3.0-or-later
// Points put together by halves, each half along the longest side of its box: order along which neighbours are near.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace meshlode::builder {

/// Runs of `order`: block b is order[first[b]] to order[first[b + 1] - 1].
struct Blocks {
  std::vector<std::uint32_t> order, first;
  [[nodiscard]] std::size_t size() const { return first.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t block) const {
    return {order.data() + first[block], first[block + 1] - first[block]};
  }
};

/// `count` blocks of about as many points each, none empty. \pre 1 <= count <= points.size()
[[nodiscard]] Blocks split_evenly(std::span<const Vec3d> points, std::size_t count);

/// 2^depth blocks of about as much weight each; a block may be empty where single weights are large.
[[nodiscard]] Blocks split_by_weight(std::span<const Vec3d> points, std::span<const std::uint32_t> weights, int depth);

}  // namespace meshlode::builder
