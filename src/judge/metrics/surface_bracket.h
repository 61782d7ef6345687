// SPDX-License-Identifier: GPL-3.0-or-later
// How far a surface is from another at most, from both sides: no samples.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "judge/metrics/metrics.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::judge {

struct BracketOptions {
  double enough = 0.0;       ///< a piece proven to be no farther than this is done with
  double tolerance = 0.002;  ///< beyond that: the search is over where `upper` is within this share of `lower`
  std::uint64_t budget = 0;  ///< splits of pieces, in all, after which those that are open are undecided
};

/// Parts of a surface that a triangle lies near to, all of it.
struct NearParts {
  static constexpr std::size_t kMost = 4;
  std::array<std::uint32_t, kMost> parts{};
  std::uint8_t count = 0;  ///< 0: not proven, or by more parts

  [[nodiscard]] bool is_proven() const { return count > 0 && count <= kMost; }
  void add(std::uint32_t part);
  void give_up() { count = kMost + 1; }
};

struct Bracket {
  double lower = 0.0;           ///< a distance that was met; 0: none, where all may be within `enough`
  double upper = 0.0;           ///< no point is farther
  Vec3d worst{0.0};             ///< where `lower` was met
  std::uint64_t undecided = 0;  ///< pieces that the budget did not reach, or not to their end
  std::uint64_t splits = 0;
  std::vector<NearParts> near;  ///< of each triangle that was looked at: what is within `enough`
};

/// A surface that others are measured against, with the part that each of its triangles belongs to.
struct BracketTarget {
  const Surface& surface;
  const TriangleTree& tree;
  std::span<const std::uint32_t> parts = {};  ///< none: all are of part 0
};

/// How far the farthest point of some triangles is from another surface, by branch and bound. A distance to a triangle
/// is convex, so a piece is no farther than the farthest of its corners from any one triangle. A piece that no triangle
/// is near enough to is split at a vertex in which triangles near to its corners meet; or on an edge, where a triangle
/// that is near to one end gives way to one that is near to the other: what lies over two triangles of a smooth surface
/// is done with after a split of each edge, however long it is.
/// Distances that are met on the way are exact. The same for any number of threads. \pre neither surface is empty
[[nodiscard]] Bracket bracket_one_way(const Surface& a, std::span<const std::uint32_t> triangles,
                                      const BracketTarget& b, const BracketOptions& options);

}  // namespace meshlode::judge
