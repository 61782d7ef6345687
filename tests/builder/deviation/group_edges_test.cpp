// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/deviation/group_edges.h"

#include <algorithm>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode::builder {
namespace {

TEST(GroupEdges, AreNumberedAsTheyAreMetAndCounted) {
  SplitMix64 random(11);
  for (int round = 0; round < 200; ++round) {
    const auto draw = [&](std::uint32_t below) { return static_cast<std::uint32_t>(random.next() % below); };
    const std::vector<Vec3d> positions(3 + draw(20), Vec3d(0.0));
    std::vector<std::array<std::uint32_t, 3>> triangles(draw(60));
    for (auto& t : triangles) {  // two corners in one place too
      for (std::uint32_t& corner : t) corner = draw(static_cast<std::uint32_t>(positions.size()));
    }
    const GroupEdges edges(GroupSurface{positions, triangles});
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ids;
    std::vector<std::uint32_t> use_count;
    ASSERT_EQ(edges.of_triangle.size(), triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
        const auto [at, is_new] = ids.try_emplace({low, high}, static_cast<std::uint32_t>(ids.size()));
        if (is_new) use_count.push_back(0);
        ++use_count[at->second];
        EXPECT_EQ(edges.of_triangle[t][k], at->second);
      }
    }
    EXPECT_EQ(edges.use_count, use_count);
    std::vector<std::uint8_t> is_border(positions.size(), 0);
    for (const auto& [ends, id] : ids) {
      if (use_count[id] == 1) is_border[ends.first] = is_border[ends.second] = 1;
    }
    EXPECT_EQ(edges.is_border_position, is_border);
  }
}

}  // namespace
}  // namespace meshlode::builder
