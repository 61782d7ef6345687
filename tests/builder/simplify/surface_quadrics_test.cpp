// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/surface_quadrics.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "builder/simplify/attribute_scales.h"
#include "builder/simplify/edge_uses.h"
#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::closed_fan;
using test::DrawnMesh;
using test::open_fan;
using test::seamed_fan;

using Edges = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

/// A texture that is laid flat on the fan, `offset` apart below the seam.
SimplifyInput with_texture(const DrawnMesh& drawn, float offset) {
  SimplifyInput input = as_input(drawn);
  input.layout.uv_set_count = 1;
  for (std::size_t w = 0; w < drawn.wedge_position.size(); ++w) {
    const Vec3i& p = drawn.points[drawn.wedge_position[w]];
    const bool is_below = w >= drawn.points.size() || (w >= 7 && w <= 9);
    input.wedge_attributes.push_back(static_cast<float>(p.x) + (is_below ? offset : 0.0F));
    input.wedge_attributes.push_back(static_cast<float>(p.y));
  }
  return input;
}

HeldEdges held_edges_of(const SimplifyInput& input, const SimplifyOptions& options, const CollapseMesh& mesh) {
  return find_held_edges(input, options, mesh, sorted_edge_uses(mesh));
}

SurfaceQuadrics<double> quadrics_of(const DrawnMesh& drawn, const HeldEdges& held) {
  SurfaceQuadrics<double> surface(drawn.points.size(), SimplifyOptions{}.border_weight);
  for (std::uint32_t t = 0; t < drawn.mesh.triangle_count(); ++t) {
    surface.add_face({drawn.mesh.vertex(3 * t), drawn.mesh.vertex(3 * t + 1), drawn.mesh.vertex(3 * t + 2)},
                     face_of(drawn.mesh, drawn.places, t));
  }
  surface.add_walls(held.edges, drawn.mesh, drawn.places);
  return surface;
}

Edges edges_of(const HeldEdges& held) {
  Edges out;
  for (const HeldEdge& edge : held.edges) out.emplace(edge.a, edge.b);
  return out;
}

TEST(HeldEdges, TheRimOfAClosedFanIsItsBorder) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  const HeldEdges held = held_edges_of(input, {}, drawn.mesh);
  EXPECT_EQ(edges_of(held), (Edges{{2, 3}, {3, 4}, {4, 5}, {5, 6}, {6, 7}, {7, 8}, {8, 9}, {2, 9}}));
  for (const HeldEdge& edge : held.edges) EXPECT_TRUE(edge.is_border && edge.weight == 1.0);
  EXPECT_EQ(held.is_border, (std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 1, 1, 1, 1}));
  EXPECT_TRUE(held.has_free_border);
  input.is_locked = held.is_border;
  EXPECT_FALSE(held_edges_of(input, {}, drawn.mesh).has_free_border) << "both ends of each are locked";
  EXPECT_TRUE(held_edges_of(input, {}, drawn.mesh).edges.empty()) << "nothing need hold what cannot move";
  EXPECT_EQ(held_edges_of(input, {}, drawn.mesh).is_border, held.is_border);
  input.is_locked[5] = 0;
  EXPECT_TRUE(held_edges_of(input, {}, drawn.mesh).has_free_border);
}

TEST(HeldEdges, TheyTellWhetherTheGroupIsAManifold) {
  const auto is_manifold = [](const std::vector<WedgeTriangle>& triangles) {
    const DrawnMesh drawn({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 4}}, triangles);
    return held_edges_of(as_input(drawn), {}, drawn.mesh).is_manifold;
  };
  EXPECT_TRUE(is_manifold({{0, 1, 2}, {1, 0, 3}}));
  EXPECT_FALSE(is_manifold({{0, 1, 2}, {0, 1, 3}})) << "both run one way along (0, 1)";
  EXPECT_FALSE(is_manifold({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})) << "three on an edge";
}

TEST(HeldEdges, AnOpenFanHasItsDiameterToo) {
  const DrawnMesh drawn = open_fan();
  EXPECT_EQ(edges_of(held_edges_of(as_input(drawn), {}, drawn.mesh)),
            (Edges{{0, 1}, {0, 6}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}}));
}

TEST(HeldEdges, WhereMaterialsMeetBothSidesHoldTheEdge) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  for (std::size_t t = 5; t < 10; ++t) input.triangle_material[t] = 7;
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> inner;
  for (const HeldEdge& edge : held_edges_of(input, {}, drawn.mesh).edges) {
    if (edge.is_border) continue;
    inner.emplace(edge.a, edge.b);
    EXPECT_EQ(edge.weight, SimplifyOptions{}.border_weight);
  }
  EXPECT_EQ(inner, (Edges{{0, 6}, {0, 6}, {0, 1}, {0, 1}, {1, 2}, {1, 2}}));
}

TEST(HeldEdges, ASeamIsHeldWhereItsTextureBreaks) {
  const DrawnMesh drawn = seamed_fan();
  const auto count_inner = [&](const SimplifyInput& input) {
    int count = 0;
    for (const HeldEdge& edge : held_edges_of(input, {}, drawn.mesh).edges) {
      if (!edge.is_border) count += edge.weight == SimplifyOptions{}.seam_weight ? 1 : 1000;
    }
    return count;
  };
  EXPECT_EQ(count_inner(with_texture(drawn, 0.5F)), 6) << "three edges, two uses each";
  EXPECT_EQ(count_inner(with_texture(drawn, 0.0F)), 0) << "two wedges of one value are no seam";
  SimplifyInput creased = with_texture(drawn, 0.0F);
  creased.layout.has_normal = true;
  std::vector<float> with_normals;
  for (std::size_t w = 0; w < drawn.wedge_position.size(); ++w) {
    const float z = w < drawn.points.size() ? 1.0F : 0.5F;
    with_normals.insert(with_normals.end(), {0.0F, 0.0F, z});
    with_normals.insert(with_normals.end(), &creased.wedge_attributes[2 * w], &creased.wedge_attributes[2 * w] + 2);
  }
  creased.wedge_attributes = with_normals;
  EXPECT_EQ(count_inner(creased), 0) << "nor is a crease, which the normals' own error keeps";
}

TEST(SurfaceQuadrics, RaisingAnEdgeCostsItsAreasTimesTheSquare) {
  const DrawnMesh drawn = closed_fan();
  const SurfaceQuadrics<double> surface = quadrics_of(drawn, {});
  // Twelve faces at the two ends (those on the edge count twice), each of 8 grid units squared.
  const double scale = drawn.places.scale(), area = 12.0 * 8.0 / (scale * scale), height = 3.0 / scale;
  const Quadric total = surface.around(0, 1);
  EXPECT_NEAR(total.weight, area, 1e-12);
  EXPECT_NEAR(surface.weight(0) + surface.weight(1), area, 1e-12);
  EXPECT_NEAR(surface.total_weight(), 3.0 * 10.0 * 8.0 / (scale * scale), 1e-12);
  EXPECT_NEAR(total.evaluate(drawn.places.to_frame({1, -1, 3})), area * height * height, 1e-12);
  EXPECT_NEAR(total.evaluate(drawn.places.to_frame({1, -1, 0})), 0.0, 1e-12) << "along the plane it costs nothing";
}

TEST(SurfaceQuadrics, ABorderMayBeSlidAlongAndNotMovedOff) {
  const DrawnMesh drawn = open_fan();
  const SurfaceQuadrics<double> surface = quadrics_of(drawn, held_edges_of(as_input(drawn), {}, drawn.mesh));
  const Quadric total = surface.around(0, 1);
  EXPECT_NEAR(total.evaluate(drawn.places.to_frame({3, 0, 0})), 0.0, 1e-12);
  // Walls on (6, 0), (0, 1) twice, and (1, 2), each of length 4; 2 grid units off.
  const double scale = drawn.places.scale();
  const double walls = 4.0 * 16.0 / (scale * scale), off = 2.0 / scale;
  EXPECT_NEAR(total.evaluate(drawn.places.to_frame({3, 2, 0})), SimplifyOptions{}.border_weight * walls * off * off,
              1e-12);
  EXPECT_NEAR(total.weight, surface.weight(0) + surface.weight(1), 1e-15) << "walls have no area";
}

TEST(SurfaceQuadrics, ASeamIsAWallFromBothSides) {
  const DrawnMesh drawn = seamed_fan();
  const SurfaceQuadrics<double> surface = quadrics_of(drawn, held_edges_of(with_texture(drawn, 0.5F), {}, drawn.mesh));
  const double scale = drawn.places.scale();
  const double walls = 2.0 * 4.0 * 16.0 / (scale * scale), off = 1.0 / scale;
  EXPECT_NEAR(surface.around(0, 1).evaluate(drawn.places.to_frame({2, 1, 0})),
              SimplifyOptions{}.seam_weight * walls * off * off, 1e-12);
}

TEST(SurfaceQuadrics, AJoinedVertexStandsForBothAndTellsItsError) {
  const DrawnMesh drawn = open_fan();
  SurfaceQuadrics<double> surface = quadrics_of(drawn, held_edges_of(as_input(drawn), {}, drawn.mesh));
  const Quadric before = surface.around(0, 1);
  const double scale = drawn.places.scale();
  const double error = std::sqrt(surface.join(0, 1, drawn.places.to_frame({2, 3, 1})));
  EXPECT_NEAR(error, 3.0 / scale, 1e-12) << "3 off the border is more than 1 off the plane";
  EXPECT_NEAR(surface.weight(0), before.weight, 1e-15);
  EXPECT_NEAR(surface.around(0, 3).weight, before.weight + surface.weight(3), 1e-12);
  SurfaceQuadrics<double> nothing(drawn.points.size(), SimplifyOptions{}.border_weight);
  EXPECT_EQ(nothing.join(0, 1, drawn.places[5]), 0.0) << "no face, no border, no error";
}

TEST(Face, WithoutAreaHasNoNormal) {
  const DrawnMesh drawn({{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}, {{0, 1, 2}});
  EXPECT_EQ(face_of(drawn.mesh, drawn.places, 0).twice_area, 0.0);
}

TEST(AttributeScales, AreDistancesOnTheSurface) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = with_texture(drawn, 0.0F);
  for (float& value : input.wedge_attributes) value *= 2.0F;
  const SimplifyOptions options;
  // A step of one grid unit is 1 / scale in the frame and 2 in the texture.
  const std::vector<double> scales = attribute_scales(input, options, drawn.mesh, drawn.places);
  ASSERT_EQ(scales.size(), 2U);
  EXPECT_NEAR(scales[0], options.uv_weight / (2.0 * drawn.places.scale()), 1e-12);
  EXPECT_EQ(scales[1], scales[0]);
  for (float& value : input.wedge_attributes) value = 0.25F;
  EXPECT_EQ(attribute_scales(input, options, drawn.mesh, drawn.places), (std::vector<double>{0.0, 0.0}))
      << "a texture of one point does not count";
}

TEST(AttributeScales, NormalsAndColoursWeighLessOnFineMeshesOnly) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  input.layout.has_normal = input.layout.has_color = true;
  input.wedge_attributes.assign(drawn.points.size() * 7, 0.5F);
  const std::vector<double> scales = attribute_scales(input, {}, drawn.mesh, drawn.places);
  ASSERT_EQ(scales.size(), 7U);
  EXPECT_EQ(scales[2], SimplifyOptions{}.normal_weight * 0.05) << "ten triangles are coarse: their side is capped";
  EXPECT_EQ(scales[3], SimplifyOptions{}.color_weight * 0.05);
}

}  // namespace
}  // namespace meshlode::builder
