// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstddef>

#include "base/ids.h"
#include "builder/cluster/merged_partition.h"

namespace meshlode::builder {

namespace {

/// Per node the one that it joins, itself where it stays alone.
std::vector<std::uint32_t> match(const Graph& graph) {
  const auto count = static_cast<std::uint32_t>(graph.node_count());
  std::vector<std::uint32_t> mate(count, kNoId);
  std::vector<std::int32_t> alone(count);  // neighbours without a mate
  for (std::uint32_t n = 0; n < count; ++n) alone[n] = graph.row_start[n + 1] - graph.row_start[n];
  const auto for_each_edge = [&](std::uint32_t node, auto&& visit) {
    for (auto i = static_cast<std::size_t>(graph.row_start[node]);
         i < static_cast<std::size_t>(graph.row_start[node + 1]); ++i) {
      visit(static_cast<std::uint32_t>(graph.neighbor[i]), graph.edge_weight[i]);
    }
  };
  const auto settle = [&](std::uint32_t node, std::uint32_t with) {
    mate[node] = with;
    for_each_edge(node, [&](std::uint32_t other, std::int32_t) { --alone[other]; });
  };
  for (std::uint32_t n = 0; n < count; ++n) {
    if (mate[n] != kNoId) continue;
    std::uint32_t best = n;
    std::int32_t best_weight = 0;
    for_each_edge(n, [&](std::uint32_t other, std::int32_t weight) {
      if (mate[other] != kNoId || weight < best_weight) return;
      const bool is_better =
          weight > best_weight || alone[other] < alone[best] || (alone[other] == alone[best] && other < best);
      if (!is_better) return;
      best = other;
      best_weight = weight;
    });
    settle(n, best);
    if (best != n) settle(best, n);
  }
  return mate;
}

}  // namespace

MergedGraph merge_pairs(const Graph& graph) {
  const std::vector<std::uint32_t> mate = match(graph);
  MergedGraph merged;
  merged.node.assign(mate.size(), kNoId);
  std::vector<std::uint32_t> first;  // by merged node
  for (std::uint32_t n = 0; n < mate.size(); ++n) {
    if (merged.node[n] != kNoId) continue;
    merged.node[n] = merged.node[mate[n]] = static_cast<std::uint32_t>(first.size());
    first.push_back(n);
  }
  Graph& coarse = merged.graph;
  coarse.row_start.reserve(first.size() + 1);
  coarse.row_start.push_back(0);
  coarse.node_weight.reserve(first.size());
  coarse.neighbor.resize(graph.neighbor.size());  // so many at most
  coarse.edge_weight.resize(graph.neighbor.size());
  std::int32_t end = 0;
  std::vector<std::int32_t> slot(first.size(), -1);  // of a neighbour in the row that is being written
  for (std::uint32_t m = 0; m < first.size(); ++m) {
    const std::int32_t row = end;
    std::int32_t weight = 0;
    const auto add = [&](std::uint32_t node) {
      weight += graph.node_weight.empty() ? 1 : graph.node_weight[node];
      for (auto i = static_cast<std::size_t>(graph.row_start[node]);
           i < static_cast<std::size_t>(graph.row_start[node + 1]); ++i) {
        const std::uint32_t other = merged.node[static_cast<std::size_t>(graph.neighbor[i])];
        if (other == m) continue;
        if (slot[other] < row) {
          slot[other] = end;
          coarse.neighbor[static_cast<std::size_t>(end)] = static_cast<std::int32_t>(other);
          coarse.edge_weight[static_cast<std::size_t>(end++)] = graph.edge_weight[i];
        } else {
          coarse.edge_weight[static_cast<std::size_t>(slot[other])] += graph.edge_weight[i];
        }
      }
    };
    add(first[m]);
    if (mate[first[m]] != first[m]) add(mate[first[m]]);
    coarse.node_weight.push_back(weight);
    coarse.row_start.push_back(end);
  }
  coarse.neighbor.resize(static_cast<std::size_t>(end));
  coarse.edge_weight.resize(static_cast<std::size_t>(end));
  return merged;
}

}  // namespace meshlode::builder
