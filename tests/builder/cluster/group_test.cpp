// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/cluster/group.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace meshlode::builder {
namespace {

/// side · side clusters in the plane, each sharing 8 border vertices with its right and lower neighbour.
GroupInput grid_of_clusters(std::uint32_t side, bool connected = true) {
  GroupInput input;
  std::vector<std::vector<std::uint32_t>> lists(side * side);
  std::uint32_t next = 0;
  const auto share = [&](std::uint32_t a, std::uint32_t b) {
    for (int k = 0; k < 8; ++k) {
      lists[a].push_back(next);
      lists[b].push_back(next++);
    }
  };
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t c = y * side + x;
      input.centers.emplace_back(x, y, 0.0);
      if (connected && x + 1 < side) share(c, c + 1);
      if (connected && y + 1 < side) share(c, c + side);
    }
  }
  input.first_position.push_back(0);
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    input.positions.insert(input.positions.end(), list.begin(), list.end());
    input.first_position.push_back(static_cast<std::uint32_t>(input.positions.size()));
  }
  input.position_count = next;
  input.weights.assign(side * side, 10);
  return input;
}

void expect_partition(const std::vector<std::vector<std::uint32_t>>& groups, std::uint32_t count) {
  std::vector<int> seen(count, 0);
  for (const auto& group : groups) {
    EXPECT_TRUE(std::is_sorted(group.begin(), group.end()));
    for (const std::uint32_t c : group) ++seen.at(c);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), count);
}

TEST(Group, EveryClusterIsInOneGroupOfTheSizeAskedFor) {
  const auto groups = group_clusters(grid_of_clusters(16), {});
  expect_partition(groups, 256);
  EXPECT_EQ(groups.size(), 13U);
  for (const auto& group : groups) {
    EXPECT_GE(group.size(), 8U);
    EXPECT_LE(group.size(), 32U);
  }
}

TEST(Group, ClustersThatShareNothingAreGroupedByNearness) {
  const auto groups = group_clusters(grid_of_clusters(16, false), {});
  expect_partition(groups, 256);
  for (const auto& group : groups) {
    std::uint32_t low_x = 99;
    std::uint32_t high_x = 0;
    std::uint32_t low_y = 99;
    std::uint32_t high_y = 0;
    for (const std::uint32_t c : group) {
      low_x = std::min(low_x, c % 16);
      high_x = std::max(high_x, c % 16);
      low_y = std::min(low_y, c / 16);
      high_y = std::max(high_y, c / 16);
    }
    EXPECT_LE((high_x - low_x + 1) * (high_y - low_y + 1), 80U) << "sixteen near clusters, not sixteen anywhere";
  }
}

TEST(Group, NoGroupIsLargerThanItsLimits) {
  GroupOptions options;
  options.max_weight = 55;
  const auto groups = group_clusters(grid_of_clusters(12), options);
  expect_partition(groups, 144);
  for (const auto& group : groups) EXPECT_LE(group.size(), 5U);
}

TEST(Group, AClusterOverTheLimitIsAGroupOfItsOwn) {
  GroupInput input = grid_of_clusters(4);
  input.weights[5] = 1000;
  GroupOptions options;
  options.max_weight = 100;
  const auto groups = group_clusters(input, options);
  expect_partition(groups, 16);
}

TEST(Group, FewClustersAreOneGroup) {
  EXPECT_EQ(group_clusters(grid_of_clusters(4), {}).size(), 1U);
  EXPECT_EQ(group_clusters(grid_of_clusters(1), {}).size(), 1U);
  EXPECT_TRUE(group_clusters(GroupInput{}, {}).empty());
}

}  // namespace
}  // namespace meshlode::builder
