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

TEST(NewSurface, IsAsFarAsItsMiddlesAreFromWhatItReplaces) {
  DrawnMesh drawn = closed_fan();
  NewSurface surface;
  CollapseStar star = drawn.star(0, 1);
  EXPECT_NEAR(surface.distance2(drawn.mesh, drawn.places, star, 0.0), 0.0, 1e-15);
  star.target = drawn.places.to_frame({2, 0, 6});
  EXPECT_NEAR(surface.distance2(drawn.mesh, drawn.places, star, 0.0), in_frame(drawn, 9), 1e-6)
      << "the middles of the edges at the target";
  EXPECT_EQ(surface.distance2(drawn.mesh, drawn.places, star, 0.5), 0.5) << "what nobody asks about";
}

/// Every point against every triangle.
double plain_new_surface_distance2(const DrawnMesh& drawn, const CollapseStar& star, double least) {
  std::vector<std::uint32_t> corners = star.a.corners;
  corners.insert(corners.end(), star.b.corners.begin(), star.b.corners.end());
  const auto at = [&](std::uint32_t corner) { return drawn.places[drawn.mesh.vertex(corner)]; };
  double farthest = least;
  for (const CollapseStar::OuterEdge& edge : star.outer) {
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
  NewSurface surface;
  for (int round = 0; round < 300; ++round) {
    // Triangles around 0 and 1 as they fall, among few points (flat, folded, on each other) or around a hub.
    const bool is_hub = round % 10 == 0;
    const std::uint32_t count = is_hub ? 90 : 4 + random.below(8);
    std::vector<Vec3i> points;
    for (std::uint32_t v = 0; v < count; ++v) points.push_back(random_point(random, round % 3 == 0 ? 3 : 1000));
    std::vector<WedgeTriangle> triangles{{0, 1, 2}};
    for (std::uint32_t v = 2; v + 1 < count; ++v) {
      triangles.push_back({random.below(2), v, v + 1});
      const std::uint32_t x = 2 + random.below(count - 2), y = 2 + random.below(count - 2);
      if (x != y && !is_hub) triangles.push_back({random.below(2), x, y});
    }
    DrawnMesh drawn(points, triangles);
    CollapseStar star = drawn.star(0, 1, round % 2 == 0);
    star.target = drawn.places.to_frame(random_point(random, 1000));
    const double exact = plain_new_surface_distance2(drawn, star, 0.0);
    for (const double least : {0.0, 0.5 * exact, exact, 2.0 * exact}) {
      EXPECT_NEAR(surface.distance2(drawn.mesh, drawn.places, star, least),
                  plain_new_surface_distance2(drawn, star, least), kFloats)
          << "seed 41, round " << round;
    }
  }
}

TEST(StarFacets, ThePointsAreAskedOfOneTriangleEachOrOfAll) {
  test::RandomSource random(61);
  const auto draw = [&] { return Vec3d(0.01 * (Vec3d(random_point(random, 201)) - Vec3d(100.0))); };
  StarFacets facets;
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t count = 1 + random.below(11);
    std::vector<std::array<Vec3d, 3>> triangles(count);
    std::vector<Vec3d> points(1 + random.below(count));
    facets.start(draw());
    for (auto& [a, b, c] : triangles) {
      a = draw();
      b = round % 4 == 0 ? a : draw();  // a segment
      c = round % 8 == 0 ? b : draw();  // a point
      facets.add(a, b, c);
    }
    facets.finish();
    ASSERT_EQ(facets.size(), count);
    for (Vec3d& point : points) point = draw();
    std::vector<float> one_by_one;
    facets.distances2_one_by_one(points, one_by_one);
    for (std::size_t i = 0; i < points.size(); ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& [a, b, c] : triangles) nearest = std::min(nearest, distance2_to_facet(points[i], a, b, c));
      const auto& [a, b, c] = triangles[i];
      EXPECT_NEAR(double{one_by_one[i]}, distance2_to_facet(points[i], a, b, c), kFloats) << "seed 61, " << round;
      EXPECT_NEAR(double{facets.distance2_to(points[i])}, nearest, kFloats) << "seed 61, round " << round;
      EXPECT_GE(double{facets.distance2_to(points[i], 0.5F)}, nearest - kFloats) << "seed 61, round " << round;
      EXPECT_EQ(facets.distance2_to(points[i], 0.5F) <= 0.5F, facets.distance2_to(points[i]) <= 0.5F);
    }
  }
  facets.start(Vec3d(0.0));
  facets.finish();
  EXPECT_EQ(facets.distance2_to(Vec3d(1.0)), std::numeric_limits<float>::infinity()) << "nothing is near";
}

}  // namespace
}  // namespace meshlode::builder
