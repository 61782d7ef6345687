// SPDX-License-Identifier: GPL-3.0-or-later
// Partition: the one place that calls METIS (Karypis and Kumar 1998, multilevel recursive bisection).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

/// An undirected graph in compressed rows. Each edge is listed at both of its ends with the same weight; no loops.
struct Graph {
  std::vector<std::int32_t> row_start;  ///< node count + 1
  std::vector<std::int32_t> neighbor;
  std::vector<std::int32_t> edge_weight;  ///< positive, as long as neighbor
  std::vector<std::int32_t> node_weight;  ///< empty: all 1

  [[nodiscard]] std::size_t node_count() const { return row_start.empty() ? 0 : row_start.size() - 1; }
};

/// One label in [0, parts) per node; every part is non-empty if parts <= nodes. Deterministic for any thread, thread
/// count and caller. Balanced to one in a thousand where the graph allows; caps are the caller's to enforce.
/// If METIS refuses (it reports no memory, say) nodes are dealt out in index order: never a failure, seldom good.
/// Another `seed` gives another partition, no better or worse on average.
[[nodiscard]] std::vector<std::uint32_t> partition_graph(Graph& graph, std::uint32_t parts, std::uint32_t seed = 1);
/// The same into parts that weigh as their shares are to each other. \pre each is positive
[[nodiscard]] std::vector<std::uint32_t> partition_graph(Graph& graph, std::span<const std::uint32_t> shares,
                                                         std::uint32_t seed);
/// Of labels below `parts`: where there are empty parts, the largest one gives up its last node each time.
void fill_empty_parts(std::vector<std::uint32_t>& labels, std::uint32_t parts);

/// True if calls may run side by side: the executable brings its own rand() (meshlode_thread_rand). Otherwise calls
/// wait for each other; the labels are the same.
[[nodiscard]] bool is_partition_concurrent();

}  // namespace meshlode::builder
