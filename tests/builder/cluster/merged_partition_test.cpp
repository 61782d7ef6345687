// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/merged_partition.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/cluster/adjacency.h"

namespace meshlode::builder {
namespace {

using Edge = std::tuple<std::uint32_t, std::uint32_t, std::int32_t>;

Graph graph_of(std::uint32_t nodes, const std::vector<Edge>& edges) {
  std::vector<std::map<std::uint32_t, std::int32_t>> rows(nodes);
  for (const auto& [a, b, weight] : edges) {
    rows[a][b] += weight;
    rows[b][a] += weight;
  }
  Graph graph;
  graph.row_start.push_back(0);
  for (const auto& row : rows) {
    for (const auto& [other, weight] : row) {
      graph.neighbor.push_back(static_cast<std::int32_t>(other));
      graph.edge_weight.push_back(weight);
    }
    graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
  }
  return graph;
}

/// n · n squares of two triangles each.
Graph sheet(std::uint32_t n) {
  std::vector<std::array<std::uint32_t, 3>> corners;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t q = j * (n + 1) + i;
      corners.push_back({q, q + 1, q + n + 2});
      corners.push_back({q, q + n + 2, q + n + 1});
    }
  }
  return TriangleLinks(corners).graph();
}

/// Of the triangles of a sheet.
std::vector<Vec3f> centers_of_sheet(std::uint32_t n) {
  std::vector<Vec3f> centers;
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      centers.emplace_back(3 * i + 2, 3 * j + 1, 0);
      centers.emplace_back(3 * i + 1, 3 * j + 2, 0);
    }
  }
  return centers;
}

Graph random_graph(SplitMix64& random, std::uint32_t nodes) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < 2 * nodes; ++i) {
    const std::uint32_t a = random.scaled_below(nodes), b = random.scaled_below(nodes);
    if (a != b) pairs.emplace(std::min(a, b), std::max(a, b));
  }
  std::vector<Edge> edges;
  for (const auto& [a, b] : pairs) edges.emplace_back(a, b, 1 + static_cast<std::int32_t>(random.below(4)));
  return graph_of(nodes, edges);
}

std::int64_t cut_weight(const Graph& graph, const std::vector<std::uint32_t>& labels) {
  std::int64_t cut = 0;
  for (std::size_t n = 0; n < graph.node_count(); ++n) {
    for (auto i = static_cast<std::size_t>(graph.row_start[n]); i < static_cast<std::size_t>(graph.row_start[n + 1]);
         ++i) {
      if (labels[n] != labels[static_cast<std::size_t>(graph.neighbor[i])]) cut += graph.edge_weight[i];
    }
  }
  return cut / 2;
}

std::vector<std::int64_t> sizes_of(const std::vector<std::uint32_t>& labels, std::uint32_t parts) {
  std::vector<std::int64_t> sizes(parts, 0);
  for (const std::uint32_t label : labels) ++sizes.at(label);
  return sizes;
}

TEST(MergePairs, TheHeaviestEdgeIsTaken) {
  // 0 -1- 1 -5- 2 -1- 3: 0 comes first and takes 1; had 1 come first it would have taken 2.
  EXPECT_EQ(merge_pairs(graph_of(4, {{0, 1, 1}, {1, 2, 5}, {2, 3, 1}})).node, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(merge_pairs(graph_of(4, {{0, 1, 1}, {0, 2, 5}, {2, 3, 1}, {1, 3, 1}})).node,
            (std::vector<std::uint32_t>{0, 1, 0, 1}));
}

TEST(MergePairs, OfEqualsTheOneWithFewestNeighboursAloneThenTheFirst) {
  // 2 would be left without anybody, 1 would not.
  EXPECT_EQ(merge_pairs(graph_of(4, {{0, 1, 1}, {0, 2, 1}, {1, 3, 1}})).node, (std::vector<std::uint32_t>{0, 1, 0, 1}));
  EXPECT_EQ(merge_pairs(graph_of(3, {{0, 1, 1}, {0, 2, 1}})).node, (std::vector<std::uint32_t>{0, 0, 1}));
}

TEST(MergePairs, WeightsAddUpAndParallelEdgesBecomeOne) {
  Graph square = graph_of(4, {{0, 1, 9}, {2, 3, 9}, {0, 2, 2}, {1, 3, 3}});
  square.node_weight = {1, 2, 3, 4};
  const MergedGraph merged = merge_pairs(square);
  EXPECT_EQ(merged.node, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(merged.graph.node_weight, (std::vector<std::int32_t>{3, 7}));
  EXPECT_EQ(merged.graph.row_start, (std::vector<std::int32_t>{0, 1, 2}));
  EXPECT_EQ(merged.graph.neighbor, (std::vector<std::int32_t>{1, 0}));
  EXPECT_EQ(merged.graph.edge_weight, (std::vector<std::int32_t>{5, 5}));
}

TEST(MergePairs, IsMaximalAndKeepsEveryCut) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    SplitMix64 random(seed);
    const Graph graph = random_graph(random, 2 + random.scaled_below(200));
    const MergedGraph merged = merge_pairs(graph);
    const auto merged_count = static_cast<std::uint32_t>(merged.graph.node_count());
    const std::vector<std::int64_t> members = sizes_of(merged.node, merged_count);
    for (std::uint32_t m = 0; m < merged_count; ++m) EXPECT_EQ(merged.graph.node_weight[m], members[m]);
    for (const std::int64_t count : members) EXPECT_TRUE(count == 1 || count == 2);
    for (std::size_t n = 0; n < graph.node_count(); ++n) {
      for (auto i = static_cast<std::size_t>(graph.row_start[n]); i < static_cast<std::size_t>(graph.row_start[n + 1]);
           ++i) {
        const auto other = static_cast<std::size_t>(graph.neighbor[i]);
        EXPECT_TRUE(members[merged.node[n]] == 2 || members[merged.node[other]] == 2) << n << " and " << other;
      }
    }
    std::vector<std::uint32_t> coarse(merged_count);
    for (std::uint32_t& label : coarse) label = random.scaled_below(3);
    std::vector<std::uint32_t> fine;
    for (const std::uint32_t node : merged.node) fine.push_back(coarse[node]);
    EXPECT_EQ(cut_weight(merged.graph, coarse), cut_weight(graph, fine));
  }
}

TEST(MergePairs, NothingAndOneNode) {
  EXPECT_EQ(merge_pairs(graph_of(0, {})).graph.node_count(), 0U);
  EXPECT_EQ(merge_pairs(graph_of(1, {})).node, (std::vector<std::uint32_t>{0}));
}

TEST(RefineParts, ANodeGoesWhereItHasMoreEdges) {
  const Graph path = graph_of(6, {{0, 1, 1}, {1, 2, 1}, {2, 3, 1}, {3, 4, 1}, {4, 5, 1}});
  std::vector<std::uint32_t> labels{0, 1, 0, 0, 1, 1};
  refine_parts(path, {1, 4}, 4, labels, 2);
  EXPECT_EQ(cut_weight(path, labels), 1);
}

TEST(RefineParts, WhatIsTooHeavyGivesAwayEvenAtALoss) {
  // Two triangles of edges, joined by one: four nodes in part 0 where three are allowed.
  const Graph graph = graph_of(6, {{0, 1, 2}, {1, 2, 2}, {0, 2, 2}, {3, 4, 2}, {4, 5, 2}, {3, 5, 2}, {2, 3, 1}});
  std::vector<std::uint32_t> labels{0, 0, 0, 0, 0, 1};
  refine_parts(graph, {1, 3}, 8, labels, 2);
  EXPECT_EQ(sizes_of(labels, 2), (std::vector<std::int64_t>{3, 3}));
  EXPECT_EQ(cut_weight(graph, labels), 1);
}

TEST(RefineParts, ThereIsNoMoveThatACapForbids) {
  const Graph star = graph_of(4, {{0, 1, 1}, {0, 2, 1}, {0, 3, 1}});
  std::vector<std::uint32_t> labels{0, 1, 1, 1};
  refine_parts(star, {1, 3}, 4, labels, 2);
  EXPECT_EQ(labels[0], 0U) << "part 0 would be empty";
  labels = {0, 1, 1, 1};
  refine_parts(star, {0, 3}, 4, labels, 2);
  EXPECT_EQ(labels[0], 0U) << "part 1 would weigh four";
}

TEST(RefineParts, CapsHoldAndTheBorderNeverGrows) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    SplitMix64 random(seed);
    const std::uint32_t parts = 2 + random.scaled_below(6);
    Graph graph = random_graph(random, 20 * parts);
    for (std::size_t n = 0; n < graph.node_count(); ++n) {
      graph.node_weight.push_back(1 + static_cast<std::int32_t>(random.below(3)));
    }
    std::vector<std::uint32_t> labels(graph.node_count());
    for (std::size_t n = 0; n < labels.size(); ++n) labels[n] = static_cast<std::uint32_t>(n % parts);
    const auto weight_of_parts = [&] {
      std::vector<std::int64_t> sum(parts, 0);
      for (std::size_t n = 0; n < labels.size(); ++n) sum[labels[n]] += graph.node_weight[n];
      return sum;
    };
    const std::vector<std::int64_t> before = weight_of_parts();
    const PartWeights weights{*std::min_element(before.begin(), before.end()) - 2,
                              *std::max_element(before.begin(), before.end()) + 1};
    const std::int64_t cut = cut_weight(graph, labels);
    refine_parts(graph, weights, 5, labels, parts);
    EXPECT_LE(cut_weight(graph, labels), cut);
    for (const std::int64_t weight : weight_of_parts()) {
      EXPECT_GE(weight, weights.least);
      EXPECT_LE(weight, weights.most);
    }
  }
}

/// Every node has one label, no label is missing, and no part is far from the mean.
void expect_partition(Graph graph, const std::vector<Vec3f>& centers, std::uint32_t parts, std::int64_t over) {
  const auto nodes = static_cast<std::int64_t>(graph.node_count());
  const std::vector<std::uint32_t> labels = partition_merged(graph, centers, parts);
  ASSERT_EQ(labels.size(), graph.node_count());
  for (const std::int64_t size : sizes_of(labels, parts)) {
    EXPECT_GT(size, 0);
    EXPECT_LE(size, (nodes + parts - 1) / parts + over);
  }
  EXPECT_EQ(partition_merged(graph, centers, parts), labels) << "another time";
}

TEST(PartitionMerged, CoversASheetInEvenParts) {
  expect_partition(sheet(60), centers_of_sheet(60), 57, 2);  // 7,200 triangles, 126.3 a part
  expect_partition(sheet(8), centers_of_sheet(8), 2, 1);
}

TEST(PartitionMerged, TheBorderIsAboutThatOfMetis) {
  Graph graph = sheet(60);
  const std::vector<std::uint32_t> merged = partition_merged(graph, centers_of_sheet(60), 57);
  const std::vector<std::uint32_t> whole = partition_graph(graph, 57);
  EXPECT_LT(static_cast<double>(cut_weight(graph, merged)), 1.12 * static_cast<double>(cut_weight(graph, whole)));
}

TEST(PartitionMerged, NothingOneNodeAndLooseNodes) {
  Graph nothing = graph_of(0, {});
  EXPECT_TRUE(partition_merged(nothing, {}, 1).empty());
  Graph one = graph_of(1, {});
  EXPECT_EQ(partition_merged(one, std::vector(1, Vec3f(0.0F)), 1), (std::vector<std::uint32_t>{0}));
  Graph soup = graph_of(2000, {});
  const std::vector<std::uint32_t> labels = partition_merged(soup, std::vector(2000, Vec3f(0.0F)), 16);
  for (const std::int64_t size : sizes_of(labels, 16)) EXPECT_GT(size, 0);
  std::vector<std::array<std::uint32_t, 3>> loose(1000);
  for (std::uint32_t t = 0; t < loose.size(); ++t) loose[t] = {3 * t, 3 * t + 1, 3 * t + 2};
  expect_partition(TriangleLinks(loose).graph(), std::vector(loose.size(), Vec3f(0.0F)), 8, 4);
}

/// A hub of ten thousand neighbours costs what its edges cost, in both directions of the search.
TEST(PartitionMerged, AHubIsNoTrouble) {
  std::vector<Edge> edges;
  for (std::uint32_t n = 1; n < 10000; ++n) {
    edges.emplace_back(0, n, 8);
    if (n > 1) edges.emplace_back(n - 1, n, 8);
  }
  Graph graph = graph_of(10000, edges);
  const std::vector<std::uint32_t> labels = partition_merged(graph, std::vector(10000, Vec3f(0.0F)), 80);
  for (const std::int64_t size : sizes_of(labels, 80)) EXPECT_GT(size, 0);
}

}  // namespace
}  // namespace meshlode::builder
