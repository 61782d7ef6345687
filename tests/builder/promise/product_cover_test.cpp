// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds in the product space: never exceeded, whatever the surfaces, and not much larger than need be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "builder/promise/product_cover.h"

namespace meshlode::builder {
namespace {

constexpr std::size_t kSpace = 8;  // positions, one set of UVs and normals
using Surface8 = ProductSurface<kSpace>;

/// Loose triangles of about `size` in a cube of `extent`; every so many of them needles, segments and points.
Surface8 soup8(SplitMix64& random, std::uint32_t count, double extent, double size, std::uint32_t odd_each) {
  Surface8 out;
  for (std::uint32_t t = 0; t < count; ++t) {
    ProductPoint<kSpace> middle, corner;
    for (double& x : middle) x = extent * random.signed_unit();
    for (std::uint32_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < kSpace; ++d) corner[d] = middle[d] + size * random.signed_unit();
      out.points.push_back(corner);
    }
    const std::size_t first = 3 * std::size_t{t};
    if (odd_each > 0 && t % odd_each == 0) {
      for (std::size_t d = 0; d < kSpace; ++d)
        out.points[first + 2][d] = 0.5 * (out.points[first][d] + out.points[first + 1][d]) + 1e-9 * size;
      if (t % (2 * odd_each) == 0) out.points[first + 2] = out.points[first + random.below(2)];
      if (t % (4 * odd_each) == 0) out.points[first + 1] = out.points[first];
    }
    out.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return out;
}

/// The farthest of many points of one surface from all triangles of the other.
double farthest8(const Surface8& from, const Surface8& to, SplitMix64& random, int points) {
  double farthest2 = 0.0;
  for (int i = 0; i < points; ++i) {
    double b = random.unit(), c = random.unit();
    if (b + c > 1.0) b = 1.0 - b, c = 1.0 - c;
    if (i % 4 == 0) b = i % 8 == 0 ? 1.0 : 0.0, c = 0.0;
    const auto q = from.at(static_cast<std::uint32_t>(random.below(from.triangles.size())), b, c);
    double nearest2 = std::numeric_limits<double>::infinity();
    for (const auto& [i0, i1, i2] : to.triangles)
      nearest2 = std::min(nearest2, product_distance2<kSpace>(q, to.points[i0], to.points[i1], to.points[i2]));
    farthest2 = std::max(farthest2, nearest2);
  }
  return std::sqrt(farthest2);
}

std::vector<TriangleBound> no_bounds8(const Surface8& surface) {
  return std::vector<TriangleBound>(surface.triangles.size());
}

TEST(ProductCover, HoldsForRandomSurfaces) {
  SplitMix64 random(31);
  for (int round = 0; round < 150; ++round) {
    const double scale = round % 3 == 0 ? 1e-6 : round % 3 == 1 ? 1.0 : 1e9;
    const auto soup = [&] {
      return soup8(random, static_cast<std::uint32_t>(1 + random.below(20)), scale,
                   scale * (0.05 + 0.5 * static_cast<double>(random.below(3))), round % 4 == 0 ? 2 : 0);
    };
    const Surface8 a = soup(), b = soup();
    const double truth = std::max(farthest8(a, b, random, 1500), farthest8(b, a, random, 1500));
    const double bound = hand_on(a, no_bounds8(a), b, 0.0).deviation;
    ASSERT_GE(bound, truth) << "round " << round;
    ASSERT_LE(bound, 1.25 * truth) << "round " << round;
  }
}

TEST(ProductCover, HoldsAlongAChain) {
  SplitMix64 random(32);
  const Surface8 source = soup8(random, 40, 1.0, 0.5, 5);
  Surface8 finer = source;
  std::vector<TriangleBound> bounds = no_bounds8(source);
  for (int level = 0; level < 4; ++level) {
    Surface8 coarser = finer;  // half of the triangles, moved
    coarser.triangles.resize((finer.triangles.size() + 1) / 2);
    for (auto& point : coarser.points) {
      for (double& x : point) x += 0.02 * random.signed_unit();
    }
    const auto step = hand_on(finer, bounds, coarser, 0.0);
    ASSERT_EQ(step.bounds.size(), coarser.triangles.size());
    EXPECT_GE(step.deviation, farthest8(source, coarser, random, 4000)) << level;
    // What is proven of each triangle by itself: of its points, that the source is so near.
    for (std::size_t t = 0; t < coarser.triangles.size(); ++t) {
      Surface8 one = coarser;
      one.triangles = {coarser.triangles[t]};
      EXPECT_GE(step.bounds[t].to_source, farthest8(one, source, random, 200)) << level << " " << t;
    }
    finer = std::move(coarser);
    bounds = step.bounds;
  }
}

TEST(ProductCover, ASurfaceIsAsGoodAsItselfAndNothingIsAsGoodAsNothing) {
  SplitMix64 random(33);
  const Surface8 some = soup8(random, 60, 1.0, 0.3, 4), nothing;
  EXPECT_LE(hand_on(some, no_bounds8(some), some, 0.0).deviation, 1e-7);
  EXPECT_EQ(hand_on(nothing, {}, nothing, 0.0).deviation, 0.0);
  EXPECT_EQ(hand_on(some, no_bounds8(some), nothing, 0.0).deviation, std::numeric_limits<double>::infinity());
  const auto step = hand_on(nothing, {}, some, 0.0);
  EXPECT_EQ(step.deviation, std::numeric_limits<double>::infinity());
  for (const TriangleBound& bound : step.bounds) EXPECT_EQ(bound.to_source, std::numeric_limits<double>::infinity());
}

/// A triangle that is within what is enough of one that is named is as far as its farthest corner, and nothing is
/// looked for.
TEST(ProductCover, OfPartnersTheFarthestCornerCounts) {
  Surface8 a, b;
  for (std::size_t k = 0; k < 3; ++k) {
    ProductPoint<kSpace> corner{};
    corner[k] = 4.0;
    b.points.push_back(corner);
    corner[7] = k == 0 ? 0.3 : k == 1 ? 0.1 : 0.2;
    a.points.push_back(corner);
  }
  a.triangles = b.triangles = {{0, 1, 2}};
  const std::vector<std::uint32_t> partners{0};
  const std::vector<GivenPiece> given = cover_product_surface(a, b, 1.0, partners);
  ASSERT_EQ(given.size(), 1U);
  EXPECT_NEAR(given[0].bound, 0.3, 1e-12);
}

TEST(ProductCover, WhatIsGoodEnoughIsNotLookedAtCloser) {
  SplitMix64 random(34);
  const Surface8 a = soup8(random, 30, 1.0, 0.5, 0), b = soup8(random, 30, 1.0, 0.5, 0);
  const double close = hand_on(a, no_bounds8(a), b, 0.0).deviation;
  const double loose = hand_on(a, no_bounds8(a), b, 10.0).deviation;
  EXPECT_GE(loose, close);
  EXPECT_LE(loose, 10.0);
}

}  // namespace
}  // namespace meshlode::builder
