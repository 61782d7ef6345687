// SPDX-License-Identifier: GPL-3.0-or-later
// Partitions of large meshes for half the price: triangles are merged into pairs and those into quads, METIS cuts the
// quads, and what lies on the borders is then moved triangle by triangle. The multilevel scheme of Karypis and Kumar
// (1998), whose two finest levels, which METIS spends most of its time on, are ours: matched without random numbers,
// and refined under a cap that holds for every part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/cluster/partition.h"

namespace meshlode::builder {

/// A graph whose nodes are one or two nodes of a finer one.
struct MergedGraph {
  Graph graph;                      ///< node and edge weights are sums; what joined two nodes that are one now is gone
  std::vector<std::uint32_t> node;  ///< by finer node
};

/// Heavy-edge matching: each node in turn that is still alone joins the neighbour still alone that its heaviest edge
/// leads to; of equals the one with the fewest neighbours still alone, and then the first. No edge is left between two
/// nodes that are alone (the matching is maximal). Merged nodes are numbered by their first member.
[[nodiscard]] MergedGraph merge_pairs(const Graph& graph);

/// What a part may weigh, as a sum of node weights. \pre 0 < least <= most
struct PartWeights {
  std::int64_t least = 1, most = 1;
};

/// Moves nodes on borders between parts, one at a time and in order, to where they have more edges, or as many and the
/// other part is lighter; from a part that weighs too much also at a loss. No part comes to weigh more than the most by
/// it, or less than the least, and so no part becomes empty. At most so many passes over all nodes.
void refine_parts(const Graph& graph, const PartWeights& weights, int passes, std::vector<std::uint32_t>& labels,
                  std::uint32_t parts);

/// As partition_graph, in less time and with a slightly longer border. Graphs of few nodes a part go to partition_graph
/// as they are. `centers`: where each node lies.
[[nodiscard]] std::vector<std::uint32_t> partition_merged(Graph& graph, std::span<const Vec3f> centers,
                                                          std::uint32_t parts, std::uint32_t seed = 1);

}  // namespace meshlode::builder
