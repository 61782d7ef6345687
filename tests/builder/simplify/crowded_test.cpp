// SPDX-License-Identifier: GPL-3.0-or-later
// A collapse looks at so many triangles, and no more: what is larger is refused, and the refusals are counted.
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/collapse_star.h"
#include "builder/simplify/simplify.h"
#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::DrawnMesh;

/// With the vertices from the first named on locked.
SimplifyResult simplify(const DrawnMesh& drawn, std::uint32_t first_locked, std::uint32_t target) {
  SimplifyInput input = as_input(drawn);
  for (std::uint32_t v = first_locked; v < drawn.points.size(); ++v) input.is_locked[v] = 1;
  SimplifyOptions options;
  options.target_triangles = target;
  return simplify_group(input, options);
}

/// A flat wheel around 0, its rim from 1 on.
DrawnMesh wheel(std::uint32_t spokes) {
  std::vector<Vec3i> points{{0, 0, 0}};
  std::vector<WedgeTriangle> triangles;
  for (std::uint32_t i = 0; i < spokes; ++i) {
    const double turn = 2.0 * 3.14159265358979 * i / spokes;
    points.emplace_back(static_cast<int>(1e5 * std::cos(turn)), static_cast<int>(1e5 * std::sin(turn)), 0);
    triangles.push_back({0, 1 + i, 1 + (i + 1) % spokes});
  }
  return {points, triangles};
}

TEST(Crowded, AHubIsNotJoinedToItsRim) {
  const SimplifyResult most = simplify(wheel(Ring::kMost), 1, 2);
  EXPECT_LT(most.triangles.size(), Ring::kMost);
  EXPECT_EQ(most.crowded, 0U);
  const SimplifyResult hub = simplify(wheel(Ring::kMost + 1), 1, 2);
  EXPECT_EQ(hub.triangles.size(), Ring::kMost + 1);
  EXPECT_EQ(hub.crowded, Ring::kMost + 1) << "each spoke, once";
}

TEST(Crowded, AHubLosesItsRimUntilItIsNone) {
  const SimplifyResult hub = simplify(wheel(20000), 20001, 8);
  EXPECT_LE(hub.triangles.size(), 8U);
}

TEST(Crowded, AnEdgeOfTooManyTrianglesStays) {
  const auto book = [](std::uint32_t pages) {
    std::vector<Vec3i> points{{0, 0, 0}, {0, 0, 9}};
    std::vector<WedgeTriangle> triangles;
    for (std::uint32_t p = 0; p < pages; ++p) {
      points.push_back({100, static_cast<int>(20 * p), 0});
      triangles.push_back({0, 1, 2 + p});
    }
    return simplify(DrawnMesh(points, triangles), 1, 1).crowded;
  };
  EXPECT_EQ(book(CollapseStar::kMostOnEdge), 0U);
  EXPECT_EQ(book(CollapseStar::kMostOnEdge + 1), 1U);
}

// 0 and 1 are close, so that their edge comes first; with it the leaves between their triangles would go.
TEST(Crowded, NoMoreVerticesGoAtOnceThanAreWeighed) {
  const auto leaves = [](std::uint32_t count) {
    std::vector<Vec3i> points{{0, 0, 0}, {1, 0, 0}, {0, 5000, 0}, {5000, 5000, 0}};
    std::vector<WedgeTriangle> triangles{{0, 1, 2}, {1, 3, 2}};
    for (std::uint32_t e = 0; e < count; ++e) {
      const auto x = static_cast<int>(900 * e);
      points.push_back({x, -6000, 1000});
      points.push_back({x, -6000, 2000});
      triangles.push_back({0, 4 + 2 * e, 5 + 2 * e});
      triangles.push_back({1, 5 + 2 * e, 4 + 2 * e});
    }
    const auto all = static_cast<std::uint32_t>(triangles.size());
    return simplify(DrawnMesh(points, triangles), 2, all - 1).crowded;
  };
  EXPECT_EQ(leaves(4), 0U) << "eight, with both ends ten";
  EXPECT_EQ(leaves(5), 1U);
}

}  // namespace
}  // namespace meshlode::builder
