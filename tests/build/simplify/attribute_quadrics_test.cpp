// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/simplify/attribute_quadrics.h"

#include <gtest/gtest.h>

#include "support/drawn_mesh.h"

namespace meshlode::build {
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
  AttributeQuadrics<double, 3> attributes(input, std::move(scales));
  for (std::uint32_t t = 0; t < drawn.mesh.triangle_count(); ++t) {
    attributes.add_face({drawn.mesh.wedge(3 * t), drawn.mesh.wedge(3 * t + 1), drawn.mesh.wedge(3 * t + 2)},
                        face_of(drawn.mesh, drawn.places, t));
  }
  return attributes;
}

std::vector<float> written(const AttributeQuadrics<double, 3>& attributes, std::uint32_t wedge,
                           bool is_locked = false) {
  std::vector<float> out;
  attributes.write(wedge, is_locked, out);
  return out;
}

TEST(AttributeQuadrics, ALinearTextureMayBeMovedFreelyAndStaysWhereItWas) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  const std::vector<WedgeClass> classes{{{0, 1}}};
  const Vec3d place = drawn.places.to_frame({3, 1, 0});
  Quadric total;
  EXPECT_EQ(attributes.add_classes(total, classes, Vec3d(0.0)), 0.0) << "nothing is fixed";
  EXPECT_NEAR(total.evaluate(place), 0.0, 1e-9);
  attributes.join(classes[0], place);
  EXPECT_NEAR(written(attributes, 0)[0], 4.0F, 1e-5F);
  EXPECT_NEAR(written(attributes, 0)[1], 2.0F, 1e-5F);
}

TEST(AttributeQuadrics, AFixedValueCostsWhatItIsOff) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  const std::vector<WedgeClass> classes{{{0, 1}, 0}};
  Quadric total;
  EXPECT_NEAR(attributes.add_classes(total, classes, drawn.places[0]), 0.0, 1e-9) << "where it belongs";
  // At the place of 1 the texture is 4 further in u: off by 4 over the twelve faces at both, 8 grid units squared each.
  const double area = 12.0 * 8.0 / (drawn.places.scale() * drawn.places.scale());
  EXPECT_NEAR(attributes.add_classes(total, classes, drawn.places[1]), area * 16.0, 1e-9);
  EXPECT_EQ(total.evaluate(drawn.places[1]), 0.0) << "no function of the place";
  attributes.join(classes[0], drawn.places[1]);
  EXPECT_EQ(written(attributes, 0), (std::vector<float>{1.0F, 0.0F})) << "and it stays as it is";
}

TEST(AttributeQuadrics, LockedWedgesOfOneValueAgree) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = linear_texture(drawn);
  input.wedge_attributes[2] = input.wedge_attributes[0];  // of 1 as of 0
  input.wedge_attributes[3] = input.wedge_attributes[1];
  const AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0});
  GroupLocks locks(std::vector<std::uint8_t>(10, 0), std::vector<std::uint8_t>(10, 0), drawn.wedge_position);
  EXPECT_TRUE(attributes.agree({{0, 1, 2}}, locks)) << "none is locked";
  locks.is_wedge_locked = {1, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(attributes.agree({{0, 1, 2}, 0}, locks)) << "two are, of one value";
  locks.is_wedge_locked[2] = 1;
  EXPECT_FALSE(attributes.agree({{0, 1, 2}, 0}, locks)) << "2 is another";
}

TEST(AttributeQuadrics, WhatIsLockedOrDoesNotCountIsWrittenAsItCame) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = linear_texture(drawn);
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {0.7, 0.0});
  attributes.join({{0, 1}}, drawn.places[1]);
  EXPECT_NEAR(written(attributes, 0)[0], 5.0F, 1e-5F) << "moved to the place of 1";
  EXPECT_EQ(written(attributes, 0)[1], 0.0F);
  EXPECT_EQ(written(attributes, 0, true), (std::vector<float>{1.0F, 0.0F}));
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
  attributes.join({{0, 1}}, drawn.places.to_frame({2, 0, 0}));
  const std::vector<float> n = written(attributes, 0);
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
  attributes.join({{0}}, drawn.places[1]);
  EXPECT_NEAR(written(attributes, 0)[0], 1.0F, 1e-6F) << "the mean of the three, wherever it is";
}

TEST(AttributeQuadrics, ANormalThatVanishesIsWrittenAsItCame) {
  // Across a sliver the mean counts: of opposite normals it is nothing.
  const DrawnMesh drawn({{0, 0, 0}, {100000, 0, 0}, {50000, 1, 0}}, {{0, 1, 2}});
  SimplifyInput input = as_input(drawn);
  input.layout.has_normal = true;
  input.wedge_attributes = {1.0F, 0.0F, 0.0F, -1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
  AttributeQuadrics<double, 3> attributes = quadrics_of(drawn, input, {1.0, 1.0, 1.0});
  attributes.join({{0}}, drawn.places[0]);
  EXPECT_EQ(written(attributes, 0), (std::vector<float>{1.0F, 0.0F, 0.0F}));
}

TEST(AttributeQuadrics, WithoutAttributesThereAreNone) {
  const DrawnMesh drawn = closed_fan();
  const SimplifyInput input = as_input(drawn);
  const AttributeQuadrics<double, 3> attributes(input, {});
  EXPECT_EQ(attributes.count(), 0U);
  Quadric total;
  EXPECT_EQ(attributes.add_classes(total, {}, Vec3d(0.0)), 0.0);
}

}  // namespace
}  // namespace meshlode::build
