// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/new_surface.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/point_triangle.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::closed_fan;
using test::DrawnMesh;
using test::in_frame;
using test::kFloats;
using test::random_point;

double distance2(DrawnMesh& drawn, CollapseStar star, double least) {
  return double{new_surface_distance2(drawn.mesh, drawn.places, star, static_cast<float>(least))};
}

TEST(NewSurface, IsAsFarAsItsMiddlesAreFromWhatItReplaces) {
  DrawnMesh drawn = closed_fan();
  EXPECT_NEAR(distance2(drawn, drawn.star(0, 1), 0.0), 0.0, 1e-15);
  const CollapseStar raised = drawn.star_at(drawn.places.to_frame({2, 0, 6}), 0, 1);
  EXPECT_NEAR(distance2(drawn, raised, 0.0), in_frame(drawn, 9), 1e-6) << "the middles of the edges at the target";
  EXPECT_EQ(distance2(drawn, raised, 0.5), 0.5) << "what nobody asks about";
}

/// Every point against every triangle.
double plain_new_surface_distance2(const DrawnMesh& drawn, const CollapseStar& star, double least) {
  std::vector<std::uint32_t> corners(star.a.corners().begin(), star.a.corners().end());
  corners.insert(corners.end(), star.b.corners().begin(), star.b.corners().end());
  const auto at = [&](std::uint32_t corner) { return drawn.places[drawn.mesh.vertex(corner)]; };
  double farthest = least;
  for (const CollapseStar::OuterEdge& edge : star.outer()) {
    const Vec3d x = drawn.places[edge.x], y = drawn.places[edge.y];
    for (const Vec3d& point : {(star.target + x + y) / 3.0, (star.target + x) * 0.5, (star.target + y) * 0.5}) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const std::uint32_t corner : corners) {
        const std::uint32_t first = corner - corner % 3;
        nearest = std::min(nearest, distance2_to_facet(point, at(first), at(first + 1), at(first + 2)));
      }
      farthest = std::max(farthest, nearest);
    }
  }
  return farthest;
}

TEST(NewSurface, IsThatOfEveryPointAgainstEveryTriangle) {
  test::RandomSource random(41);
  for (int round = 0; round < 300; ++round) {
    // Triangles around 0 and 1 as they fall, among few points (flat, folded, on each other) or around a hub.
    const bool is_hub = round % 10 == 0;
    const std::uint32_t count = is_hub ? 30 : 4 + random.below(8);
    std::vector<Vec3i> points;
    for (std::uint32_t v = 0; v < count; ++v) points.push_back(random_point(random, round % 3 == 0 ? 3 : 1000));
    std::vector<WedgeTriangle> triangles{{0, 1, 2}};
    for (std::uint32_t v = 2; v + 1 < count; ++v) {
      triangles.push_back({random.below(2), v, v + 1});
      const std::uint32_t x = 2 + random.below(count - 2), y = 2 + random.below(count - 2);
      if (x != y && !is_hub) triangles.push_back({random.below(2), x, y});
    }
    DrawnMesh drawn(points, triangles);
    const CollapseStar star = drawn.star_at(drawn.places.to_frame(random_point(random, 1000)), 0, 1, round % 2 == 0);
    const double exact = plain_new_surface_distance2(drawn, star, 0.0);
    for (const double least : {0.0, 0.5 * exact, exact, 2.0 * exact}) {
      EXPECT_NEAR(distance2(drawn, star, least), plain_new_surface_distance2(drawn, star, least), kFloats)
          << "seed 41, round " << round;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
