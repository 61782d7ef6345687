// SPDX-License-Identifier: GPL-3.0-or-later
// Of a group, ids are 0, 1, 2 … nearly without gaps, and serve as places in tables as they are; those of a part of a
// mesh are scattered, and want local ids first.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace meshlode::builder {

/// A limit of the triangles' ids, where that is not much more than there are triangles; else 0.
[[nodiscard]] inline std::uint32_t dense_limit(std::span<const std::array<std::uint32_t, 3>> triangles) {
  constexpr std::size_t kIdsPerTriangle = 4;  // without shared corners there are three
  std::uint32_t greatest = 0;
  for (const auto& [a, b, c] : triangles) greatest = std::max({greatest, a, b, c});
  return greatest < kIdsPerTriangle * triangles.size() ? greatest + 1 : 0;
}

}  // namespace meshlode::builder
