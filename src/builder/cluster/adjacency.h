// SPDX-License-Identifier: GPL-3.0-or-later
// Which triangles share an edge, as a weighted graph for the partitioner.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/ids.h"
#include "builder/cluster/partition.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Weight of a shared edge, and of a link that only keeps near pieces together.
constexpr std::int32_t kSharedEdgeWeight = 8;
constexpr std::int32_t kNearbyWeight = 1;

using TriangleLink = std::pair<std::uint32_t, std::uint32_t>;

/// Triangles as nodes, in the order given, joined where they share an edge: what is known before the graph is made. An
/// edge with more than two triangles links them in a chain, so that a fan of thousands stays linear.
class TriangleLinks {
 public:
  /// Position ids are compacted inside.
  explicit TriangleLinks(std::span<const std::array<std::uint32_t, 3>> corner_positions);

  /// The piece of each triangle: pieces are what links join, and numbered by their first triangle. \returns how many
  std::uint32_t find_pieces(std::vector<std::uint32_t>& piece);
  /// Pairs to be joined as by a shared edge.
  void add(std::span<const TriangleLink> links);
  /// Of the triangles without a host (kNoId), in their order.
  [[nodiscard]] TriangleLinks without(std::span<const std::uint32_t> hosts) const;
  /// Triangles that follow each other but belong to different pieces are linked weakly first: the caller's order is
  /// taken as spatial, and loose pieces near each other stay together. Called last.
  [[nodiscard]] Graph graph();

 private:
  explicit TriangleLinks(std::size_t count) : degree_(count, 0), few_(count), pieces_(count) {}
  void link_along_edges(const std::vector<std::array<std::uint32_t, 3>>& corners, std::uint32_t position_count);
  void link(std::uint32_t a, std::uint32_t b, std::int32_t weight) {
    put(a, std::uint64_t{b} << 32U | static_cast<std::uint32_t>(weight));
    put(b, std::uint64_t{a} << 32U | static_cast<std::uint32_t>(weight));
    if (weight == kSharedEdgeWeight) pieces_.join(a, b);
  }
  void put(std::uint32_t from, std::uint64_t entry) {
    const std::uint32_t at = degree_[from]++;
    if (at < kFew) {
      few_[from][at] = entry;
    } else {
      more_.emplace_back(from, entry);
    }
  }
  [[nodiscard]] Graph rows();

  // Rows, while links come in any order. Nearly every triangle has three at most, which have their place.
  static constexpr std::uint32_t kFew = 3;
  std::vector<std::uint32_t> degree_;
  std::vector<std::array<std::uint64_t, kFew>> few_;           ///< neighbour and weight
  std::vector<std::pair<std::uint32_t, std::uint64_t>> more_;  ///< triangle, and what its row has beyond those
  DisjointSets pieces_;
};

}  // namespace meshlode::builder
