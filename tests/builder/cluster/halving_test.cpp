// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/halving.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode::builder {
namespace {

/// A grid of width · height nodes, each joined to its four neighbours; every node weighs as much as given.
Graph grid_of(std::uint32_t width, std::uint32_t height, std::int32_t weight) {
  Graph graph;
  graph.row_start.push_back(0);
  const auto add = [&](std::uint32_t x, std::uint32_t y) {
    graph.neighbor.push_back(static_cast<std::int32_t>(y * width + x));
    graph.edge_weight.push_back(3);
  };
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      if (y > 0) add(x, y - 1);
      if (x > 0) add(x - 1, y);
      if (x + 1 < width) add(x + 1, y);
      if (y + 1 < height) add(x, y + 1);
      graph.row_start.push_back(static_cast<std::int32_t>(graph.neighbor.size()));
      graph.node_weight.push_back(weight);
    }
  }
  return graph;
}

/// Of such a grid, seen from the side.
std::vector<Vec3f> centers_of(std::uint32_t width, std::uint32_t height) {
  std::vector<Vec3f> centers;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) centers.emplace_back(x, 2.0F * static_cast<float>(x), 3 * y);
  }
  return centers;
}

std::vector<std::uint32_t> labels_of(const Graph& graph, const std::vector<Vec3f>& centers, std::uint32_t parts) {
  std::vector<std::uint32_t> nodes(graph.node_count()), labels(graph.node_count(), 99);
  std::iota(nodes.begin(), nodes.end(), 0U);
  Halving(graph, centers).cut(nodes, parts, 0, labels);
  return labels;
}

std::int64_t cut_of(const Graph& graph, const std::vector<std::uint32_t>& labels) {
  std::int64_t cut = 0;
  for (std::uint32_t n = 0; n < graph.node_count(); ++n) {
    for (std::int32_t i = graph.row_start[n]; i < graph.row_start[n + 1]; ++i) {
      const auto edge = static_cast<std::size_t>(i);
      if (labels[n] != labels[static_cast<std::size_t>(graph.neighbor[edge])]) cut += graph.edge_weight[edge];
    }
  }
  return cut / 2;
}

std::vector<std::int64_t> weights_of(const Graph& graph, const std::vector<std::uint32_t>& labels,
                                     std::uint32_t parts) {
  std::vector<std::int64_t> weights(parts, 0);
  for (std::uint32_t n = 0; n < labels.size(); ++n) weights.at(labels[n]) += graph.node_weight[n];
  return weights;
}

TEST(Halving, ARectangleIsCutAcrossItsShortSide) {
  const Graph graph = grid_of(12, 6, 4);
  const std::vector<std::uint32_t> labels = labels_of(graph, centers_of(12, 6), 2);
  EXPECT_EQ(weights_of(graph, labels, 2), (std::vector<std::int64_t>{144, 144}));
  EXPECT_EQ(cut_of(graph, labels), 6 * 3);
}

TEST(Halving, PartsWeighTheSameWithinANode) {
  for (std::uint32_t parts = 2; parts <= 8; ++parts) {
    SCOPED_TRACE(parts);
    const Graph graph = grid_of(16, 2 * parts, 4);  // 32 nodes a part
    const std::vector<std::uint32_t> labels = labels_of(graph, centers_of(16, 2 * parts), parts);
    for (const std::int64_t weight : weights_of(graph, labels, parts)) {
      EXPECT_NEAR(static_cast<double>(weight), 128.0, 8.0);
    }
  }
}

/// A cut in the wrong place is mended by its edges: a ring is cut in two places wherever its nodes lie.
TEST(Halving, CentersThatSayNothingAreMadeUpForByRefinement) {
  const Graph graph = grid_of(12, 6, 4);
  const std::vector<std::uint32_t> labels = labels_of(graph, std::vector(72, Vec3f(1.0F)), 2);
  EXPECT_EQ(weights_of(graph, labels, 2), (std::vector<std::int64_t>{144, 144}));
  EXPECT_LE(cut_of(graph, labels), 12 * 3);
}

/// What is cut may be a part of the graph, and keeps to its labels.
TEST(Halving, NodesOutsideAreLeftAlone) {
  const Graph graph = grid_of(8, 8, 1);
  std::vector<std::uint32_t> nodes(32), labels(64, 99);
  std::iota(nodes.begin(), nodes.end(), 32U);
  const std::vector<Vec3f> centers = centers_of(8, 8);
  Halving(graph, centers).cut(nodes, 4, 10, labels);
  EXPECT_EQ(std::count(labels.begin(), labels.begin() + 32, 99U), 32);
  for (std::uint32_t label = 10; label < 14; ++label) EXPECT_EQ(std::count(labels.begin(), labels.end(), label), 8);
}

TEST(Halving, LooseNodesAndFewNodes) {
  Graph loose;
  loose.row_start.assign(41, 0);
  loose.node_weight.assign(40, 4);
  for (const std::int64_t weight : weights_of(loose, labels_of(loose, centers_of(40, 1), 5), 5)) EXPECT_EQ(weight, 32);
  const Graph pair = grid_of(2, 1, 4);
  EXPECT_EQ(labels_of(pair, centers_of(2, 1), 1), (std::vector<std::uint32_t>{0, 0}));
  EXPECT_EQ(labels_of(pair, centers_of(2, 1), 2), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(labels_of(pair, centers_of(2, 1), 3), (std::vector<std::uint32_t>{0, 1})) << "the third part has nothing";
}

TEST(Halving, NoPartIsEmptyWhateverTheWeights) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    SplitMix64 random(seed);
    const std::uint32_t width = 2 + random.scaled_below(7), height = 2 + random.scaled_below(7);
    Graph graph = grid_of(width, height, 1);
    const std::vector<Vec3f> centers =
        seed % 3 == 0 ? std::vector(width * height, Vec3f(7.0F)) : centers_of(width, height);
    for (std::int32_t& weight : graph.node_weight) weight = 1 + static_cast<std::int32_t>(random.below(30));
    const auto nodes = static_cast<std::uint32_t>(graph.node_count());
    const std::uint32_t parts = 1 + random.scaled_below(std::min(8U, nodes));
    const std::vector<std::uint32_t> labels = labels_of(graph, centers, parts);
    for (const std::int64_t weight : weights_of(graph, labels, parts)) EXPECT_GT(weight, 0);
    EXPECT_EQ(labels_of(graph, centers, parts), labels) << "another time";
  }
}

}  // namespace
}  // namespace meshlode::builder
