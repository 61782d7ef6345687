// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/edge_heap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/edge_uses.h"
#include "builder/simplify/refused_edges.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::DrawnMesh;

TEST(EdgeHeap, TheCheapestComesFirstAndEqualsByTheirNumbers) {
  test::RandomSource random(58);
  for (int round = 0; round < 200; ++round) {
    EdgeHeap heap;
    std::vector<std::pair<float, std::uint32_t>> expected;
    const std::uint32_t count = random.below(60), pushed = random.below(count + 1);
    for (std::uint32_t edge = 0; edge < count; ++edge) {
      const double cost = random.chance(0.3) ? 0.25 * random.below(4) : random.log_between(1e-40, 1e30);
      expected.emplace_back(EdgeHeap::key_of(cost), edge);
      if (edge == pushed) heap.order();
      if (edge < pushed) {
        heap.append(cost, edge);
      } else {
        heap.push(cost, edge);
      }
    }
    if (pushed == count) heap.order();
    std::sort(expected.begin(), expected.end());
    while (!expected.empty()) {
      ASSERT_FALSE(heap.empty());
      const EdgeHeap::Entry top = heap.top();
      ASSERT_EQ(std::pair(top.cost, top.edge), expected.front()) << "seed 58, round " << round;
      expected.erase(expected.begin());
      if (random.chance(0.3)) {  // weighed again
        const double cost = random.log_between(1e-6, 1e6);
        heap.replace_top(cost);
        expected.emplace_back(EdgeHeap::key_of(cost), top.edge);
        std::sort(expected.begin(), expected.end());
      } else {
        heap.pop();
      }
    }
    EXPECT_TRUE(heap.empty());
  }
}

TEST(EdgeHeap, EveryDoubleHasAKeyInOrder) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(EdgeHeap::key_of(-1.0), 0.0F);
  EXPECT_EQ(EdgeHeap::key_of(-0.0), 0.0F);
  EXPECT_FALSE(std::signbit(EdgeHeap::key_of(-0.0)));
  EXPECT_EQ(EdgeHeap::key_of(0.5), 0.5F);
  EXPECT_EQ(EdgeHeap::key_of(1e300), EdgeHeap::key_of(infinity));
  EXPECT_EQ(EdgeHeap::key_of(std::numeric_limits<double>::quiet_NaN()), EdgeHeap::key_of(infinity));
  EXPECT_GT(EdgeHeap::key_of(infinity), 1e38F);
}

TEST(RefusedEdges, AreTakenOnceFromEitherEnd) {
  RefusedEdges refused;
  refused.start(4, 3);
  refused.add(0, {0, 1});
  refused.add(1, {1, 2});
  refused.add(2, {1, 3});
  std::vector<std::uint32_t> taken;
  refused.take(2, taken);
  EXPECT_EQ(taken, (std::vector<std::uint32_t>{1}));
  taken.clear();
  refused.take(1, taken);
  EXPECT_EQ(taken, (std::vector<std::uint32_t>{2, 0})) << "without the one that was taken";
  taken.clear();
  refused.take(0, taken);
  EXPECT_TRUE(taken.empty());
  refused.add(0, {0, 1});
  refused.take(0, taken);
  EXPECT_EQ(taken, (std::vector<std::uint32_t>{0})) << "refused again";
}

TEST(EdgeUses, AreAllOfTheLivingTrianglesInOrder) {
  test::RandomSource random(59);
  for (int round = 0; round < 60; ++round) {
    const std::uint32_t count = 3 + random.below(60);
    std::vector<Vec3i> points(count);
    std::vector<WedgeTriangle> triangles;
    for (std::uint32_t t = random.below(200); t > 0; --t) {
      // Around a hub in every other round. Some have two corners on one vertex, and are dropped.
      triangles.push_back({round % 2 == 0 ? 0 : random.below(count), random.below(count), random.below(count)});
    }
    const DrawnMesh drawn(points, triangles);
    std::vector<EdgeUse> expected;
    for (std::uint32_t corner = 0; corner < 3 * triangles.size(); ++corner) {
      if (!drawn.mesh.is_alive(corner / 3)) continue;
      const std::uint32_t x = drawn.mesh.vertex(corner), y = drawn.mesh.vertex(CollapseMesh::next_in_triangle(corner));
      expected.push_back({std::min(x, y), std::max(x, y), corner});
    }
    std::sort(expected.begin(), expected.end(), [](const EdgeUse& x, const EdgeUse& y) {
      return x.a != y.a ? x.a < y.a : x.b != y.b ? x.b < y.b : x.corner < y.corner;
    });
    const std::vector<EdgeUse> uses = sorted_edge_uses(drawn.mesh);
    ASSERT_EQ(uses.size(), expected.size());
    for (std::size_t i = 0; i < uses.size(); ++i) {
      ASSERT_EQ(uses[i].a, expected[i].a) << "seed 59, round " << round;
      ASSERT_EQ(uses[i].b, expected[i].b) << "seed 59, round " << round;
      ASSERT_EQ(uses[i].corner, expected[i].corner) << "seed 59, round " << round;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
