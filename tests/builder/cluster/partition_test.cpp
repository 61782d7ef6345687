// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/partition.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <thread>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

/// A grid graph of side · side nodes.
Graph grid_graph(std::int32_t side) {
  Graph graph;
  graph.row_start.push_back(0);
  for (std::int32_t y = 0; y < side; ++y) {
    for (std::int32_t x = 0; x < side; ++x) {
      if (y > 0) graph.neighbor.push_back((y - 1) * side + x);
      if (x > 0) graph.neighbor.push_back(y * side + x - 1);
      if (x + 1 < side) graph.neighbor.push_back(y * side + x + 1);
      if (y + 1 < side) graph.neighbor.push_back((y + 1) * side + x);
      graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
    }
  }
  graph.edge_weight.assign(graph.neighbor.size(), 1);
  return graph;
}

Graph without_edges(std::size_t nodes) {
  Graph graph;
  graph.row_start.assign(nodes + 1, 0);
  return graph;
}

std::vector<std::uint32_t> sizes_of(const std::vector<std::uint32_t>& labels, std::uint32_t parts) {
  std::vector<std::uint32_t> sizes(parts, 0);
  for (const std::uint32_t label : labels) ++sizes.at(label);
  return sizes;
}

/// Edges between parts.
int cut_of(const Graph& graph, const std::vector<std::uint32_t>& labels) {
  int cut = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (auto e = graph.row_start[i]; e < graph.row_start[i + 1]; ++e) {
      cut += labels[i] != labels[static_cast<std::size_t>(graph.neighbor[static_cast<std::size_t>(e)])] ? 1 : 0;
    }
  }
  return cut / 2;
}

TEST(Partition, PartsAreBalancedAndTheCutIsShort) {
  Graph graph = grid_graph(40);
  const auto labels = partition_graph(graph, 16);
  for (const std::uint32_t size : sizes_of(labels, 16)) EXPECT_NEAR(size, 100, 3);
  EXPECT_LT(cut_of(graph, labels), 2 * 24 * 10)
      << "sixteen squares of ten cut 240 edges; twice that would be no partition";
}

TEST(Partition, AnotherSeedIsAnotherPartitionAsGood) {
  Graph graph = grid_graph(40);
  const auto first = partition_graph(graph, 16);
  EXPECT_EQ(partition_graph(graph, 16, 1), first) << "the seed where none is given";
  const auto second = partition_graph(graph, 16, 2);
  EXPECT_NE(second, first);
  for (const std::uint32_t size : sizes_of(second, 16)) EXPECT_NEAR(size, 100, 3);
  EXPECT_LT(cut_of(graph, second), 2 * 24 * 10);
}

TEST(Partition, OnePartAndAsManyPartsAsNodesAreFine) {
  Graph graph = grid_graph(5);
  EXPECT_EQ(partition_graph(graph, 1), std::vector<std::uint32_t>(25, 0));
  EXPECT_EQ(partition_graph(graph, 0), std::vector<std::uint32_t>(25, 0));
  auto labels = partition_graph(graph, 25);
  std::sort(labels.begin(), labels.end());
  EXPECT_EQ(std::unique(labels.begin(), labels.end()) - labels.begin(), 25);
  Graph empty;
  EXPECT_TRUE(partition_graph(empty, 4).empty());
}

TEST(Partition, NoPartIsEmptyEvenWithoutEdges) {
  for (const std::uint32_t parts : {2U, 3U, 7U, 50U, 99U}) {
    Graph graph = without_edges(100);
    const auto labels = partition_graph(graph, parts);
    for (const std::uint32_t size : sizes_of(labels, parts)) EXPECT_GT(size, 0U) << parts << " parts";
  }
}

TEST(Partition, ThreadsDoNotDisturbEachOther) {
  Graph reference_graph = grid_graph(30);
  const auto reference = partition_graph(reference_graph, 9);
  std::vector<std::thread> threads;
  std::vector<int> differences(4, 0);
  for (std::size_t t = 0; t < differences.size(); ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 50; ++i) {
        Graph graph = grid_graph(30);
        differences[t] += partition_graph(graph, 9) != reference ? 1 : 0;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::accumulate(differences.begin(), differences.end(), 0), 0);
}

TEST(Partition, ThisProgramBringsItsOwnRand) {
  EXPECT_TRUE(is_partition_concurrent());
}

TEST(Partition, TheProgramsRandGivesGlibcsNumbers) {
  // The first values of glibc's rand() after srand(1), as its generator is documented: r[i] = r[i-3] + r[i-31].
  std::srand(1);
  EXPECT_EQ(std::rand(), 1804289383);
  EXPECT_EQ(std::rand(), 846930886);
  EXPECT_EQ(std::rand(), 1681692777);
}

}  // namespace
}  // namespace meshlode::builder
