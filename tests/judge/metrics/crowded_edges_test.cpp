// SPDX-License-Identifier: GPL-3.0-or-later
// Edges by how many triangles they have, of shapes whose counts are known.
#include <gtest/gtest.h>

#include "judge/metrics/crowded_edges.h"

namespace meshlode::judge {
namespace {

EdgeCounts count(std::initializer_list<std::array<std::uint32_t, 3>> triangles) {
  EdgeCounter counter;
  for (const auto& triangle : triangles) counter.add(triangle);
  return counter.count();
}

TEST(CrowdedEdges, ATetrahedronIsAClosedManifold) {
  const EdgeCounts counts = count({{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}});
  EXPECT_EQ(counts.edges, 6U);
  EXPECT_EQ(counts.open, 0U);
  EXPECT_EQ(counts.crowded, 0U);
}

TEST(CrowdedEdges, ATriangleIsOpenAllAround) {
  const EdgeCounts counts = count({{7, 3, 5}});
  EXPECT_EQ(counts.edges, 3U);
  EXPECT_EQ(counts.open, 3U);
  EXPECT_EQ(counts.crowded, 0U);
}

TEST(CrowdedEdges, TwoTetrahedraOnOneEdgeAreClosedAndCrowdedThere) {
  const EdgeCounts counts =
      count({{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}, {0, 1, 4}, {0, 5, 1}, {1, 5, 4}, {4, 5, 0}});
  EXPECT_EQ(counts.edges, 11U);
  EXPECT_EQ(counts.open, 0U);
  EXPECT_EQ(counts.crowded, 1U);
}

TEST(CrowdedEdges, ThreePagesOfABookAreCrowdedAndOpen) {
  const EdgeCounts counts = count({{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  EXPECT_EQ(counts.edges, 7U);
  EXPECT_EQ(counts.open, 7U);
  EXPECT_EQ(counts.crowded, 1U);
}

TEST(CrowdedEdges, EdgesBetweenEqualPositionsAreNone) {
  EdgeCounter counter;
  counter.add({1, 1, 2});
  const EdgeCounts first = counter.count();  // 1 to 2 and back
  EXPECT_EQ(first.edges, 1U);
  EXPECT_EQ(first.open, 0U);
  EXPECT_EQ(counter.count().edges, 0U) << "a count begins anew";
}

}  // namespace
}  // namespace meshlode::judge
