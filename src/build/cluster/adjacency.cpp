// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/cluster/adjacency.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/local_ids.h"

namespace meshlode::build {

namespace {

using Corner3 = std::array<std::uint32_t, 3>;

/// One end of an undirected edge, bucketed by its smaller position.
struct EdgeUse {
  std::uint32_t other;  ///< the larger position
  std::uint32_t triangle;
  auto operator<=>(const EdgeUse&) const = default;
};

/// Positions renumbered 0 … n-1. Returns n.
std::uint32_t compact(std::span<const Corner3> source, std::vector<Corner3>& out) {
  LocalIds ids(source.size());  // a closed surface has half as many
  out.resize(source.size());
  for (std::size_t t = 0; t < source.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) out[t][k] = ids.add(source[t][k]);
  }
  return static_cast<std::uint32_t>(ids.size());
}

/// By insertion where there are few, as nearly always.
template <class It>
void sort_few(It first, It last) {
  constexpr std::ptrdiff_t kFew = 24;
  if (last - first > kFew) {
    std::sort(first, last);
    return;
  }
  for (It it = first; it != last; ++it) {
    const auto value = *it;
    It hole = it;
    for (; hole != first && value < *(hole - 1); --hole) *hole = *(hole - 1);
    *hole = value;
  }
}

/// Both ends' edge uses, sorted, in a bucket for each smaller position.
struct EdgeBuckets {
  std::vector<EdgeUse> uses;
  std::vector<std::uint32_t> start;  ///< of bucket b: uses start[b] … start[b + 1]
};

/// A counting sort of edge uses by smaller end, then a sort inside each (usually tiny) bucket.
EdgeBuckets bucket_edges(const std::vector<Corner3>& corners, std::uint32_t position_count) {
  const auto for_each_edge = [&](auto&& visit) {
    for (std::uint32_t t = 0; t < corners.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = corners[t][k];
        const std::uint32_t b = corners[t][(k + 1) % 3];
        if (a != b) visit(std::min(a, b), std::max(a, b), t);
      }
    }
  };
  EdgeBuckets buckets;
  buckets.start.assign(position_count + 1, 0);
  for_each_edge([&](std::uint32_t low, std::uint32_t, std::uint32_t) { ++buckets.start[low + 1]; });
  std::partial_sum(buckets.start.begin(), buckets.start.end(), buckets.start.begin());
  buckets.uses.resize(buckets.start.back());
  std::vector<std::uint32_t> cursor(buckets.start.begin(), buckets.start.end() - 1);
  for_each_edge([&](std::uint32_t low, std::uint32_t high, std::uint32_t t) {
    buckets.uses[cursor[low]++] = {high, t};
  });
  for (std::uint32_t bucket = 0; bucket < position_count; ++bucket) {
    sort_few(buckets.uses.begin() + buckets.start[bucket], buckets.uses.begin() + buckets.start[bucket + 1]);
  }
  return buckets;
}

/// Triangles that share an edge: those of one edge in a chain.
std::vector<TriangleLink> edge_links(const EdgeBuckets& buckets) {
  std::vector<TriangleLink> links;
  links.reserve(buckets.uses.size() / 2 + 1);
  for (std::size_t bucket = 0; bucket + 1 < buckets.start.size(); ++bucket) {
    const auto begin = buckets.uses.begin() + buckets.start[bucket];
    const auto end = buckets.uses.begin() + buckets.start[bucket + 1];
    for (auto use = begin; use != end && use + 1 != end; ++use) {
      if (use->other != (use + 1)->other || use->triangle == (use + 1)->triangle) continue;
      links.emplace_back(use->triangle, (use + 1)->triangle);
    }
  }
  return links;
}

/// Triangles that follow each other in the caller's order and are not joined by `strong` links.
std::vector<TriangleLink> weak_links(const std::vector<TriangleLink>& strong, std::uint32_t triangle_count) {
  DisjointSets connected(triangle_count);
  for (const auto& [a, b] : strong) connected.join(a, b);
  std::vector<TriangleLink> weak;
  for (std::uint32_t t = 0; t + 1 < triangle_count; ++t) {
    if (connected.find(t) != connected.find(t + 1)) weak.emplace_back(t, t + 1);
  }
  return weak;
}

/// Rows in the order of the links; a neighbour may be there more than once.
Graph graph_of_links(const std::vector<TriangleLink>& strong, const std::vector<TriangleLink>& weak,
                     std::uint32_t triangle_count) {
  Graph graph;
  graph.row_start.assign(triangle_count + 1, 0);
  for (const auto* list : {&strong, &weak}) {
    for (const auto& [a, b] : *list) {
      ++graph.row_start[a + 1];
      ++graph.row_start[b + 1];
    }
  }
  std::partial_sum(graph.row_start.begin(), graph.row_start.end(), graph.row_start.begin());
  graph.neighbor.resize(static_cast<std::size_t>(graph.row_start.back()));
  graph.edge_weight.resize(graph.neighbor.size());
  std::vector<std::int32_t> fill(graph.row_start.begin(), graph.row_start.end() - 1);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::int32_t weight) {
    graph.neighbor[static_cast<std::size_t>(fill[a])] = static_cast<std::int32_t>(b);
    graph.edge_weight[static_cast<std::size_t>(fill[a]++)] = weight;
  };
  for (const auto& [a, b] : strong) {
    add(a, b, kSharedEdgeWeight);
    add(b, a, kSharedEdgeWeight);
  }
  for (const auto& [a, b] : weak) {
    add(a, b, kNearbyWeight);
    add(b, a, kNearbyWeight);
  }
  return graph;
}

/// Sorts each row. Two triangles that share two edges become one neighbour of twice the weight: METIS wants no repeated
/// edges.
void merge_repeated(Graph& graph) {
  std::vector<std::pair<std::int32_t, std::int32_t>> row;
  std::int32_t write = 0;
  std::int32_t row_begin = 0;
  const std::size_t row_count = graph.row_start.size() - 1;
  for (std::size_t t = 0; t < row_count; ++t) {
    const std::int32_t row_end = graph.row_start[t + 1];
    row.clear();
    for (std::int32_t i = row_begin; i < row_end; ++i) {
      row.emplace_back(graph.neighbor[static_cast<std::size_t>(i)], graph.edge_weight[static_cast<std::size_t>(i)]);
    }
    row_begin = row_end;
    sort_few(row.begin(), row.end());
    graph.row_start[t] = write;
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (i > 0 && row[i].first == row[i - 1].first) {
        graph.edge_weight[static_cast<std::size_t>(write - 1)] += row[i].second;
        continue;
      }
      graph.neighbor[static_cast<std::size_t>(write)] = row[i].first;
      graph.edge_weight[static_cast<std::size_t>(write++)] = row[i].second;
    }
  }
  graph.row_start[row_count] = write;
  graph.neighbor.resize(static_cast<std::size_t>(write));
  graph.edge_weight.resize(static_cast<std::size_t>(write));
}

}  // namespace

Graph triangle_graph(std::span<const Corner3> corner_positions, std::span<const TriangleLink> links) {
  std::vector<Corner3> corners;
  const std::uint32_t position_count = compact(corner_positions, corners);
  const auto triangle_count = static_cast<std::uint32_t>(corners.size());
  std::vector<TriangleLink> strong = edge_links(bucket_edges(corners, position_count));
  strong.insert(strong.end(), links.begin(), links.end());
  Graph graph = graph_of_links(strong, weak_links(strong, triangle_count), triangle_count);
  merge_repeated(graph);
  return graph;
}

}  // namespace meshlode::build
