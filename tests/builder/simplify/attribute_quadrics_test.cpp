// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/simplify/attribute_quadrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/attribute_scales.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::closed_fan;
using test::DrawnMesh;

/// u = x + 1 and v = 2 y in grid units, weighed as they are.
SimplifyInput linear_texture(const DrawnMesh& drawn) {
  SimplifyInput input = as_input(drawn);
  input.layout.uv_set_count = 1;
  for (const std::uint32_t p : drawn.wedge_position) {
    input.wedge_attributes.push_back(static_cast<float>(drawn.points[p].x + 1));
    input.wedge_attributes.push_back(static_cast<float>(2 * drawn.points[p].y));
  }
  return input;
}

AttributeQuadrics<double, 3> quadrics_of(const DrawnMesh& drawn, const SimplifyInput& input,
                                         std::vector<double> scales) {
  AttributeQuadrics<double, 3> attributes(input, std::move(scales), true);
  for (std::uint32_t t = 0; t < drawn.mesh.triangle_count(); ++t) {
    (void)attributes.add_face({drawn.mesh.wedge(3 * t), drawn.mesh.wedge(3 * t + 1), drawn.mesh.wedge(3 * t + 2)},
                              face_of(drawn.mesh, drawn.places, t));
  }
  return attributes;
}

std::vector<float> written(const AttributeQuadrics<double, 3>& attributes, std::uint32_t wedge, const Vec3d& place,
                           bool is_locked = false) {
  std::vector<float> out;
  attributes.write(wedge, is_locked, place, out);
  return out;
}

/// Locks no vertex, and of the wedges the one named.
GroupLocks locks_of(const DrawnMesh& drawn, std::uint32_t wedge = kNoId) {
  GroupLocks locks(std::vector<std::uint8_t>(drawn.points.size(), 0),
                   std::vector<std::uint8_t>(drawn.wedge_position.size(), 0), drawn.wedge_position);
  if (wedge != kNoId) locks.is_wedge_locked[wedge] = 1;
  return locks;
}
WedgeClasses pair_of(const GroupLocks& locks, std::uint32_t x, std::uint32_t y) {
  WedgeClasses classes;
  classes.set_pair(locks, x, y);
  return classes;
}
/// What the vertices count of the wedges, whatever their values.
Quadric base_of(AttributeQuadrics<double, 3> attributes, const WedgeClasses& classes) {
  Quadric total;
  for (std::uint32_t i = 0; i < classes.count(); ++i) total += attributes.take_base(classes.wedge(i));
  return total;
}

TEST(AttributeQuadrics, ALinearTextureMayBeMovedFreelyAndStaysWhereItWas) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  const WedgeClasses classes = pair_of(locks_of(drawn), 0, 1);
  const Vec3d place = drawn.places.to_frame({3, 1, 0});
  Quadric total = base_of(attributes, classes);
  EXPECT_EQ(attributes.add_classes(total, classes, Vec3d(0.0)), 0.0) << "nothing is fixed";
  EXPECT_NEAR(total.evaluate(place), 0.0, 1e-9);
  attributes.join(classes);
  EXPECT_NEAR(written(attributes, 0, place)[0], 4.0F, 1e-5F);
  EXPECT_NEAR(written(attributes, 0, place)[1], 2.0F, 1e-5F);
  EXPECT_EQ(attributes.take_base(1).c(), 0.0) << "the wedge that stays has all of it";
  EXPECT_GT(attributes.take_base(0).c(), 0.0);
  EXPECT_EQ(attributes.take_base(0).c(), 0.0) << "once";
}

TEST(AttributeQuadrics, AFixedValueCostsWhatItIsOff) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  const WedgeClasses classes = pair_of(locks_of(drawn, 0), 0, 1);
  const Quadric base = base_of(attributes, classes);
  Quadric total;
  const auto error_at = [&](const Vec3d& place) {
    return base.evaluate(place) + attributes.add_classes(total, classes, place);
  };
  EXPECT_NEAR(error_at(drawn.places[0]), 0.0, 1e-9) << "where it belongs";
  // At the place of 1 the texture is 4 further in u: off by 4 over the twelve faces at both, 8 grid units squared each.
  const double area = 12.0 * 8.0 / (drawn.places.scale() * drawn.places.scale());
  EXPECT_NEAR(error_at(drawn.places[1]), area * 16.0, 1e-9);
  EXPECT_EQ(total.evaluate(drawn.places[1]), 0.0) << "nothing is taken off";
  attributes.join(classes);
  EXPECT_EQ(written(attributes, 0, drawn.places[1], true), (std::vector<float>{1.0F, 0.0F})) << "and it stays as it is";
}

// Two single wedges are one class, whichever of them is fixed.
TEST(AttributeQuadrics, APairIsTheClassOfItsTwo) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  const AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 3.0});
  const Vec3d given = drawn.places.to_frame({3, 1, 2});
  for (const std::uint32_t fixed : {kNoId, 0U, 1U}) {
    const GroupLocks locks = locks_of(drawn, fixed);
    const WedgeClasses classes = pair_of(locks, 0, 1);
    EXPECT_EQ(classes.fixed(0), fixed);
    Quadric of_pair = base_of(attributes, classes), of_class = of_pair;
    EXPECT_EQ(attributes.add_pair(of_pair, 0, 1, locks, given), attributes.add_classes(of_class, classes, given));
    for (const Vec3d& at : {given, drawn.places[0], Vec3d(0.25, -0.5, 1.0)}) {
      EXPECT_EQ(of_pair.evaluate(at), of_class.evaluate(at)) << fixed;
    }
    const Vec3d off(0.25, -0.5, 1.0);
    EXPECT_EQ(of_pair.evaluate(off) < base_of(attributes, classes).evaluate(off), fixed == kNoId);
  }
}

TEST(AttributeQuadrics, LockedWedgesOfOneValueAgree) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = linear_texture(drawn);
  input.wedge_attributes[2] = input.wedge_attributes[0];  // of 1 as of 0
  input.wedge_attributes[3] = input.wedge_attributes[1];
  const AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  GroupLocks locks = locks_of(drawn);
  EXPECT_TRUE(attributes.agree(pair_of(locks, 1, 2), locks)) << "none is locked";
  locks.is_wedge_locked = {1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(attributes.agree(pair_of(locks, 0, 1), locks)) << "two are, of one value";
  EXPECT_TRUE(attributes.agree(pair_of(locks, 1, 2), locks)) << "one is";
  locks.is_wedge_locked[2] = 1;
  EXPECT_FALSE(attributes.agree(pair_of(locks, 1, 2), locks)) << "2 is another";
}

TEST(AttributeQuadrics, WhatIsLockedOrDoesNotCountIsWrittenAsItCame) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {0.7, 0.0});
  attributes.join(pair_of(locks_of(drawn), 0, 1));
  EXPECT_NEAR(written(attributes, 0, drawn.places[1])[0], 5.0F, 1e-5F) << "moved to the place of 1";
  EXPECT_EQ(written(attributes, 0, drawn.places[1])[1], 0.0F);
  EXPECT_EQ(written(attributes, 0, drawn.places[1], true), (std::vector<float>{1.0F, 0.0F}));
}

TEST(AttributeQuadrics, NormalsAreWrittenOfUnitLength) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  input.layout.has_normal = true;
  for (const Vec3i& p : drawn.points) {
    // Left and right of the middle they lean apart: their mean is shorter than 1.
    const float x = p.x <= 0 ? -0.6F : p.x >= 4 ? 0.6F : 0.0F;
    for (const float n : {x, 0.0F, x == 0.0F ? 1.0F : 0.8F}) input.wedge_attributes.push_back(n);
  }
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0, 1.0});
  attributes.join(pair_of(locks_of(drawn), 0, 1));
  const std::vector<float> n = written(attributes, 0, drawn.places.to_frame({2, 0, 0}));
  EXPECT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0F, 1e-6F);
  EXPECT_NEAR(n[2], 1.0F, 1e-5F) << "upright, as the two lean by the same angle";
}

TEST(AttributeQuadrics, AcrossASliverAttributesAreConstant) {
  // 100000 long and 1 high: the gradient of the last wedge's value would be 1000 times that of any other face.
  const DrawnMesh drawn({{0, 0, 0}, {100000, 0, 0}, {50000, 1, 0}}, {{0, 1, 2}});
  SimplifyInput input = as_input(drawn);
  input.layout.uv_set_count = 1;
  input.wedge_attributes = {0.0F, 0.0F, 0.0F, 0.0F, 3.0F, 0.0F};
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  attributes.join(pair_of(locks_of(drawn), 0, 0));
  EXPECT_NEAR(written(attributes, 0, drawn.places[1])[0], 1.0F, 1e-6F) << "the mean of the three, wherever it is";
}

TEST(AttributeQuadrics, ANormalThatVanishesIsWrittenAsItCame) {
  // Across a sliver the mean counts: of opposite normals it is nothing.
  const DrawnMesh drawn({{0, 0, 0}, {100000, 0, 0}, {50000, 1, 0}}, {{0, 1, 2}});
  SimplifyInput input = as_input(drawn);
  input.layout.has_normal = true;
  input.wedge_attributes = {1.0F, 0.0F, 0.0F, -1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0, 1.0});
  attributes.join(pair_of(locks_of(drawn), 0, 0));
  EXPECT_EQ(written(attributes, 0, drawn.places[0]), (std::vector<float>{1.0F, 0.0F, 0.0F}));
}

TEST(AttributeQuadrics, WithoutAttributesThereAreNone) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = as_input(drawn);
  const AttributeQuadrics<double, 3> attributes(input, {}, false);
  EXPECT_EQ(attributes.count(), 0U);
  Quadric total;
  EXPECT_EQ(attributes.add_classes(total, WedgeClasses(), Vec3d(0.0)), 0.0);
}

// SimplifyOptions says what they are: a normal that is off counts like a distance of its weight times the side of a
// mean triangle (at most a twentieth of half the extent), and texture coordinates by the density of their set.
TEST(AttributeScales, AreThoseOfTheMeanTriangleAndOfEachSetsDensity) {
  // A strip 1000 long: half of it is 1 in the frame.
  for (const int width : {1, 2, 400}) {
    DrawnMesh drawn({{0, 0, 0}, {1000, 0, 0}, {1000, width, 0}, {0, width, 0}}, {{0, 1, 2}, {0, 2, 3}});
    SimplifyInput input = as_input(drawn);
    input.layout.has_normal = true;
    input.layout.uv_set_count = 2;
    input.layout.has_color = true;
    for (const Vec3i& p : drawn.points) {
      // The first set covers 4 by 1, the second 1/2 by 3, turned.
      const float x = p.x == 0 ? 0.0F : 1.0F, y = p.y == 0 ? 0.0F : 1.0F;
      for (const float value : {0.0F, 0.0F, 1.0F, 4.0F * x, y, 7.0F - 3.0F * y, 0.5F * x, 1.0F, 1.0F, 1.0F, 1.0F})
        input.wedge_attributes.push_back(value);
    }
    SimplifyOptions options;
    options.normal_weight = 3.0;
    options.uv_weight = 5.0;
    options.color_weight = 11.0;
    const std::vector<double> scales = attribute_scales(input, options, drawn.mesh, drawn.places);
    ASSERT_EQ(scales.size(), 11U);
    const double area = 2.0 * (width / 500.0);
    const double side = std::min(0.05, std::sqrt(area / 2.0));
    const std::vector<double> expected{3.0 * side, 5.0 * std::sqrt(area / 4.0), 5.0 * std::sqrt(area / 1.5),
                                       11.0 * side};
    const std::vector<std::size_t> of{0, 0, 0, 1, 1, 2, 2, 3, 3, 3, 3};
    for (std::size_t j = 0; j < of.size(); ++j) EXPECT_NEAR(scales[j], expected[of[j]], 1e-12) << width << " " << j;
  }
}

TEST(AttributeScales, OfCoordinatesThatCoverNothingIsZero) {
  DrawnMesh drawn = closed_fan();
  SimplifyInput input = linear_texture(drawn);
  std::fill(input.wedge_attributes.begin(), input.wedge_attributes.end(), 0.5F);
  EXPECT_EQ(attribute_scales(input, {}, drawn.mesh, drawn.places), (std::vector<double>{0.0, 0.0}));
}

// To the nearest point of the grid, on either side of zero.
TEST(GroupPlaces, ComeBackFromTheFrameAndRoundToTheNearest) {
  test::RandomSource random(52);
  for (int round = 0; round < 300; ++round) {
    std::vector<Vec3i> points;
    const double size = random.log_between(1.0, 4e6);
    for (int i = 0; i < 6; ++i) points.push_back(Vec3i(random.in_cube(size)));
    const GroupPlaces places(points);
    for (std::uint32_t v = 0; v < places.size(); ++v) {
      EXPECT_EQ(places.to_grid(places[v]), points[v]) << "seed 52, round " << round;
      const Vec3d off = random.in_cube(0.49);
      EXPECT_EQ(places.to_grid(places[v] + off / places.scale()), points[v]) << "seed 52, round " << round;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
