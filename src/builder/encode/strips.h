// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a cluster as generalised strips (docs/reference/format.md, Strips).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

using LocalTriangle = std::array<std::uint8_t, 3>;

/// Slots name old vertices: what is stored follows from the order of first use.
struct Strips {
  std::vector<std::uint32_t> first_triangle;  ///< of each strip, in the new order; the first is 0
  std::vector<bool> turns;                    ///< per triangle: right
  std::vector<std::uint8_t> slots;            ///< old vertex in each of T + 2 · strips slots
  std::vector<std::uint8_t> vertex_order;     ///< old vertex of each new one: by first use
  std::vector<std::uint32_t> references;      ///< distance of each slot that names no new vertex
  std::uint32_t reference_bits = 1;           ///< that every one fits in

  [[nodiscard]] std::uint32_t bit_count() const;
};

struct StripOptions {
  std::uint32_t trials = 8;  ///< different strips tried, the shortest stays; at least 1
};

/// `block` numbers each triangle's block, ascending: strips stay inside a block, so that blocks stay contiguous.
/// The triangles come back as they were, but in another order inside their block and rotated.
/// \pre 1 to 256 triangles, every vertex below `vertex_count` <= 256 used
[[nodiscard]] Strips make_strips(std::span<const LocalTriangle> triangles, std::span<const std::uint32_t> block,
                                 std::uint32_t vertex_count, const StripOptions& options);

}  // namespace meshlode::builder
