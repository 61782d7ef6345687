// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/candidate_queue.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/edge_uses.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::DrawnMesh;

TEST(CandidateQueue, TheCheapestComesFirstAndEqualsByTheirVertices) {
  test::RandomSource random(53);
  for (int round = 0; round < 100; ++round) {
    CandidateQueue queue;
    std::vector<Candidate> waiting;
    // Many are equal, of either sign and with both zeros, or none are, over all that doubles span.
    const auto make_cost = [&] {
      const double cost = 0.125 * random.below(8) * (random.below(4) == 0 ? -1.0 : 1.0);
      return round % 2 == 0
                 ? cost
                 : std::ldexp(cost, static_cast<int>(random.below(2000)) - 1000) + 1e-18 * random.below(9999);
    };
    const auto make = [&] { return Candidate{make_cost(), random.below(40), random.below(40), 0}; };
    for (std::uint32_t n = random.below(200); n > 0; --n) {
      waiting.push_back(make());
      queue.append(waiting.back());
    }
    queue.order();
    while (!waiting.empty()) {
      if (random.below(3) == 0) {
        waiting.push_back(make());
        queue.push(waiting.back());
      }
      const auto first = std::min_element(waiting.begin(), waiting.end(), [](const Candidate& x, const Candidate& y) {
        return std::tie(x.cost, x.a, x.b) < std::tie(y.cost, y.a, y.b);
      });
      ASSERT_FALSE(queue.empty());
      const Candidate popped = queue.pop();
      ASSERT_EQ(popped.cost, first->cost) << "seed 53, round " << round;
      ASSERT_EQ(popped.a, first->a) << "seed 53, round " << round;
      ASSERT_EQ(popped.b, first->b) << "seed 53, round " << round;
      waiting.erase(first);
    }
    EXPECT_TRUE(queue.empty());
  }
}

TEST(CandidateQueue, KeepsWhatACandidateIs) {
  CandidateQueue queue;
  queue.push({2.0, 3, 4, 9, true});
  queue.push({1.0, 1, 2, 7});
  const Candidate cheap = queue.pop(), dear = queue.pop();
  EXPECT_EQ(cheap.versions, 7U);
  EXPECT_FALSE(cheap.may_break_topology);
  EXPECT_EQ(dear.versions, 9U);
  EXPECT_TRUE(dear.may_break_topology);
  queue.push(dear);
  queue.clear();
  EXPECT_TRUE(queue.empty());
}

TEST(CandidateQueue, WhatIsWeighedAgainTakesItsPlace) {
  CandidateQueue queue;
  for (std::uint32_t i = 0; i < 30; ++i) queue.push({1.0 + i, i, i + 1, 0});
  EXPECT_EQ(queue.front().cost, 1.0);
  queue.replace_front({15.5, 0, 1, 1});
  std::vector<double> costs;
  while (!queue.empty()) costs.push_back(queue.pop().cost);
  EXPECT_TRUE(std::is_sorted(costs.begin(), costs.end()));
  EXPECT_EQ(costs.size(), 30U);
  EXPECT_EQ(costs.front(), 2.0);
  EXPECT_EQ(costs[14], 15.5);
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
