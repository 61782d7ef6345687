// SPDX-License-Identifier: GPL-3.0-or-later
// Pieces become cards, cards splats: areas, places and shapes are those of what they stand for.
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/aggregate/blocks.h"
#include "builder/aggregate/candidates.h"
#include "builder/aggregate/pieces.h"
#include "builder/prepare/prepare.h"
#include "builder/symmetric.h"
#include "lab/samples/samples.h"

namespace meshlode::builder {
namespace {

double area_of(const Corners& c) {
  return 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
}

PreparedMesh prepared(scene::Primitive shape, const AttributeLayout& layout = {}) {
  shape.material = MaterialId(0U);
  Result<PreparedMesh> mesh = prepare_mesh(lab::as_mesh(std::move(shape)), layout, {});
  EXPECT_TRUE(mesh.ok());
  return std::move(*mesh);
}

scene::Primitive quad(double width, double height) {
  scene::Primitive shape;
  shape.positions = {{0, 0, 0}, {width, 0, 0}, {width, height, 0}, {0, height, 0}};
  shape.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  shape.indices = {0, 1, 2, 0, 2, 3};
  return shape;
}

TEST(SymmetricAxes, PutTheMatrixTogetherAgain) {
  SplitMix64 random(3);
  for (int round = 0; round < 200; ++round) {
    Mat3d m(0.0);
    for (int k = 0; k < 3; ++k) {
      const Vec3d v(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
      m += outer(v, v) * (k == 2 && round % 3 == 0 ? 0.0 : random.between(0.0, 10.0));
    }
    const Axes axes = axes_of(m);
    Mat3d again(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(glm::length(axes.direction[k]), 1.0, 1e-12);
      again += outer(axes.direction[k], axes.direction[k]) * axes.value[k];
    }
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) EXPECT_NEAR(again[c][r], m[c][r], 1e-11) << round;
    }
    EXPECT_GE(axes.value[0], axes.value[1]);
    EXPECT_GE(axes.value[1], axes.value[2]);
  }
}

TEST(PieceCards, AQuadIsOneCardOfItsAreaInItsPlane) {
  const PreparedMesh mesh = prepared(quad(4.0, 1.0));
  const ByPiece pieces = find_pieces(mesh);
  ASSERT_EQ(pieces.size(), 1U);
  const std::vector<SourceMaterial> materials(1);
  const PieceCards cards = make_cards(mesh, pieces, materials);
  ASSERT_EQ(cards.cards.size(), 1U);
  const Card& card = cards.cards.cards[0];
  EXPECT_NEAR(card.area, 4.0, 1e-9);
  EXPECT_NEAR(glm::length(mesh.origin + card.center - Vec3d(2.0, 0.5, 0.0)), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(card.axis_u.x), 1.0, 1e-9) << "the longer way";
  EXPECT_NEAR(std::abs(card.normal().z), 1.0, 1e-9);
  EXPECT_NEAR(card.half_u / card.half_v, 4.0, 1e-6);
  EXPECT_FALSE(cards.is_closed[0]);
}

TEST(PieceCards, AMaskTakesAwayItsShareAndMovesTheMiddle) {
  AttributeLayout layout;
  layout.uv_set_count = 1;
  const PreparedMesh mesh = prepared(quad(2.0, 2.0), layout);
  std::vector<SourceMaterial> materials(1);
  materials[0].covers = [](double u, double) { return u < 0.5; };
  const PieceCards half = make_cards(mesh, find_pieces(mesh), materials);
  ASSERT_EQ(half.cards.size(), 1U);
  EXPECT_NEAR(half.cards.cards[0].area, 2.0, 0.2);
  EXPECT_NEAR((mesh.origin + half.cards.cards[0].center).x, 0.5, 0.1);
  materials[0].covers = [](double, double) { return false; };
  EXPECT_EQ(make_cards(mesh, find_pieces(mesh), materials).cards.size(), 0U) << "nothing is drawn of it";
}

TEST(PieceCards, ABoxIsThreeCardsThatShowWhatItShows) {
  scene::Primitive box = lab::make_cube(1, 0.5);
  for (Vec3d& p : box.positions) p = p * Vec3d(1.0, 2.0, 4.0);
  const PreparedMesh mesh = prepared(box);
  const std::vector<SourceMaterial> materials(1);
  const PieceCards cards = make_cards(mesh, find_pieces(mesh), materials);
  ASSERT_EQ(cards.cards.size(), 3U);
  EXPECT_TRUE(cards.is_closed[0]);
  std::multiset<long> areas;
  for (const Card& card : cards.cards.cards) areas.insert(std::lround(card.area * 1000.0));
  EXPECT_EQ(areas, (std::multiset<long>{2000, 4000, 8000}));
}

/// Around (3, -1, 2), 0.02 large.
Splat leaning_splat() {
  Splat splat;
  splat.center = {3, -1, 2};
  splat.axis_u = {0, 0.6, 0.8};
  splat.axis_v = {0, -0.8, 0.6};
  splat.half_u = 0.3;
  splat.half_v = 0.1;
  splat.area = 0.02;
  return splat;
}

TEST(Splat, HasTheAreaThatIsAskedForWhicheverWayUp) {
  for (const bool is_blade : {false, true}) {
    for (std::uint32_t turn = 0; turn < 4; ++turn) {
      Splat splat;
      splat.axis_u = {0, 1, 0};
      splat.axis_v = {0, 0, 1};
      splat.half_u = 0.3;
      splat.half_v = 0.1;
      splat.area = 0.2;
      splat.is_blade = is_blade;
      splat.turn = turn;
      EXPECT_NEAR(area_of(splat.corners(1.0)), 0.2, 1e-12);
      EXPECT_NEAR(area_of(splat.corners(0.5)), 0.1, 1e-12);
      EXPECT_NEAR(area_of(splat.corners(9.0)), 1.8, 1e-12);
      const Corners c = splat.corners(1.0);
      EXPECT_GT(glm::cross(c[1] - c[0], c[2] - c[0]).x, 0.0) << "around u x v";
    }
  }
}

TEST(Splat, AShortBladeThatStandsForMuchIsNotWiderThanHigh) {
  Splat splat;
  splat.center = {1, 2, 3};
  splat.axis_u = {1, 0, 0};
  splat.axis_v = {0, 1, 0};
  splat.half_u = 1e-6;
  splat.half_v = 1e-10;
  splat.area = 2.0;
  splat.is_blade = true;
  const Corners c = splat.corners(1.0);
  EXPECT_NEAR(area_of(c), 2.0, 1e-9);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(glm::length(c[k] - splat.center), 2.0);
}

TEST(Splat, StretchedToABladeStaysAroundItsCentroid) {
  for (const std::uint32_t turn : {0U, 1U, 2U, 3U}) {
    Splat splat = leaning_splat();
    splat.turn = turn;
    splat.stretch_to_blade(2.0);
    const Corners c = splat.corners(1.0);
    EXPECT_NEAR(area_of(c), 0.02, 1e-12);
    EXPECT_LT(glm::length((c[0] + c[1] + c[2]) / 3.0 - Vec3d(3, -1, 2)), 1e-12);
    const Vec3d base = 0.5 * (c[1] + c[2]);
    EXPECT_NEAR(glm::length(c[0] - base), 2.0 * std::sqrt(3.0) * 0.3, 1e-12) << "twice a rectangle of its moments";
  }
}

TEST(Splat, TurnedAnotherWayUpStaysAroundItsCentroid) {
  for (const bool is_blade : {false, true}) {
    Splat splat = leaning_splat();
    if (is_blade) splat.stretch_to_blade(2.0);
    for (const std::uint32_t way_up : {1U, 2U, 3U, 0U, 1U}) {
      splat.turn_to(way_up);
      const Corners c = splat.corners(1.0);
      EXPECT_NEAR(area_of(c), 0.02, 1e-12);
      EXPECT_LT(glm::length((c[0] + c[1] + c[2]) / 3.0 - Vec3d(3, -1, 2)), 1e-12);
    }
  }
}

TEST(Blocks, AreEvenAndHoldEveryPointOnce) {
  SplitMix64 random(8);
  std::vector<Vec3d> points;
  for (int i = 0; i < 1000; ++i) points.emplace_back(random.unit(), random.unit() * 0.1, random.unit());
  for (std::size_t i = 0; i < 50; ++i) points[i] = points[0];  // in one place: by their numbers
  for (const std::size_t count : {1U, 3U, 64U, 999U, 1000U}) {
    const Blocks blocks = split_evenly(points, count);
    ASSERT_EQ(blocks.size(), count);
    EXPECT_EQ(std::set(blocks.order.begin(), blocks.order.end()).size(), points.size());
    for (std::size_t b = 0; b < count; ++b) {
      EXPECT_GE(blocks.of(b).size(), 1U);
      EXPECT_LE(blocks.of(b).size(), 2 * (points.size() / count) + 1);
    }
  }
  std::vector<std::uint32_t> weights(points.size(), 1);
  weights[7] = 400;
  const Blocks heavy = split_by_weight(points, weights, 2);
  ASSERT_EQ(heavy.size(), 4U);
  EXPECT_EQ(heavy.order.size(), points.size());
}

TEST(Thinning, KeepsTheAreaOfEveryBlock) {
  const PreparedMesh mesh = prepared(lab::make_grass(200));
  const std::vector<SourceMaterial> materials(1);
  const PieceCards cards = make_cards(mesh, find_pieces(mesh), materials);
  ASSERT_EQ(cards.cards.size(), 200U);
  std::vector<std::uint32_t> all;
  std::vector<Vec3d> centers;
  double area = 0.0;
  for (std::uint32_t c = 0; c < 200; ++c) {
    all.push_back(c);
    centers.push_back(cards.cards.cards[c].center);
    area += cards.cards.cards[c].area;
  }
  for (const Thinning thinning : kThinnings) {
    const Splats splats = thin_out(cards.cards, all, split_evenly(centers, 30), thinning, mesh.layout.stride());
    ASSERT_EQ(splats.splats.size(), 30U);
    double kept = 0.0;
    for (const Splat& splat : splats.splats) kept += splat.area;
    EXPECT_NEAR(kept, area, 1e-9 * area);
  }
}

}  // namespace
}  // namespace meshlode::builder
