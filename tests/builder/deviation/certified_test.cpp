// SPDX-License-Identifier: GPL-3.0-or-later
// The `certified` tier: never exceeded, whatever the shapes, and not much larger than need be.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "builder/deviation/deviation.h"
#include "builder/deviation/point_distance.h"
#include "builder/deviation/surfaces.h"

namespace meshlode::builder {
namespace {

using test::Random;

std::vector<TriangleBound> no_bounds(const judge::Surface& surface) {
  return std::vector<TriangleBound>(surface.triangles.size());
}

CertifiedGroup certify_one_step(const judge::Surface& fine, const judge::Surface& coarse) {
  return certify_group(test::as_group(fine), no_bounds(fine), test::as_group(coarse));
}

TEST(Certified, AShiftedPlaneIsOffByItsShift) {
  for (const double scale : {1e-6, 1.0, 1e9}) {
    const judge::Surface plane = test::transformed(test::as_surface(lab::make_plane(6)), scale, Vec3d(0.0));
    const judge::Surface shifted =
        test::transformed(test::as_surface(lab::make_plane(4)), scale, Vec3d(0.0, 0.25 * scale, 0.0));
    const double bound = certify_one_step(plane, shifted).deviation;
    EXPECT_GE(bound, 0.25 * scale);
    EXPECT_LE(bound, 0.27 * scale);
  }
}

TEST(Certified, TheSameSurfaceIsAsGoodAsItself) {
  const judge::Surface rock = test::as_surface(lab::make_rock(8));
  EXPECT_LE(certify_one_step(rock, rock).deviation, 1e-8);
}

TEST(Certified, HoldsForRandomSurfaces) {
  Random random(21);
  for (int round = 0; round < 400; ++round) {
    const double scale = round % 3 == 0 ? 1e-6 : round % 3 == 1 ? 1.0 : 1e9;
    const auto count_a = static_cast<std::uint32_t>(1 + random.below(30));
    const auto count_b = static_cast<std::uint32_t>(1 + random.below(30));
    judge::Surface a =
        test::random_soup(random, count_a, scale, scale * (0.05 + 0.5 * static_cast<double>(random.below(3))));
    judge::Surface b =
        test::random_soup(random, count_b, scale, scale * (0.05 + 0.5 * static_cast<double>(random.below(3))));
    if (round % 4 == 0) {  // needles, segments and points
      for (std::size_t t = 0; t < a.triangles.size(); t += 2)
        a.positions[3 * t + 2] = a.positions[3 * t + random.below(2)];
      for (std::size_t t = 0; t < b.triangles.size(); t += 3) {
        b.positions[3 * t + 2] = (b.positions[3 * t] + b.positions[3 * t + 1]) * 0.5 + 1e-8 * scale;
      }
    }
    const double truth = test::dense_truth(a, b, 3000);
    const double bound = certify_one_step(a, b).deviation;
    ASSERT_GE(bound, truth) << "round " << round;
    ASSERT_LE(bound, 1.5 * truth) << "round " << round;
  }
}

TEST(Certified, HoldsAlongAChainOfLevelsForEveryPart) {
  Random random(22);
  for (int round = 0; round < 6; ++round) {
    judge::Surface fine;
    std::vector<judge::Surface> levels;
    for (const std::uint32_t n : {16U, 11U, 8U, 5U, 3U}) {
      judge::Surface level = test::as_surface(round % 3 == 0   ? lab::make_sphere(n)
                                              : round % 3 == 1 ? lab::make_torus(3 * n, 2 * n)
                                                               : lab::make_terrain(2 * n, 2 * n));
      for (Vec3d& p : level.positions) {
        p += 0.05 / n * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit());
      }
      if (fine.triangles.empty()) {
        fine = std::move(level);
      } else {
        levels.push_back(std::move(level));
      }
    }
    const judge::Surface* finer = &fine;
    std::vector<TriangleBound> bounds = no_bounds(fine);
    for (const judge::Surface& level : levels) {
      CertifiedGroup certified = certify_group(test::as_group(*finer), bounds, test::as_group(level));
      const double truth = test::dense_truth(fine, level, 5000);
      EXPECT_GE(certified.deviation, truth);
      EXPECT_LE(certified.deviation, 2.5 * truth);
      // What is proven of one triangle holds for it alone.
      for (std::size_t t = 0; t < level.triangles.size(); t += level.triangles.size() / 3 + 1) {
        const judge::Surface one{level.positions, {level.triangles[t]}};
        EXPECT_GE(certified.bounds[t].to_source, judge::DeviationFrom(one, {.samples = 100}).measure(fine).a_to_b.max);
      }
      bounds = std::move(certified.bounds);
      finer = &level;
    }
  }
}

TEST(Certified, SourcePointsAreNearTheTrianglesThatTheyWereHandedTo) {
  // Every source point must be within its bound of some triangle: with the smallest bounds that are claimed.
  const judge::Surface fine = test::as_surface(lab::make_rock(12)), coarse = test::as_surface(lab::make_rock(4));
  const CertifiedGroup certified = certify_one_step(fine, coarse);
  Random random(23);
  for (int i = 0; i < 3000; ++i) {
    const auto& t = fine.triangles[random.below(fine.triangles.size())];
    const double u = 0.5 * (random.signed_unit() + 1.0), v = (1.0 - u) * 0.5 * (random.signed_unit() + 1.0);
    const Vec3d p = fine.positions[t[0]] * (1.0 - u - v) + fine.positions[t[1]] * u + fine.positions[t[2]] * v;
    bool is_covered = false;
    for (std::size_t k = 0; k < coarse.triangles.size() && !is_covered; ++k) {
      const auto& c = coarse.triangles[k];
      const double d2 =
          point_triangle_distance2(p, {coarse.positions[c[0]], coarse.positions[c[1]], coarse.positions[c[2]]});
      is_covered = std::sqrt(d2) <= certified.bounds[k].from_source;
    }
    EXPECT_TRUE(is_covered);
  }
}

TEST(Certified, TheGridsOwnShiftIsInTheFirstBound) {
  const TriangleBound bound =
      initial_bound({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, {{{0, 0, 0.25}, {1, 0, 0}, {0, 1, 0.125}}});
  EXPECT_GE(bound.from_source, 0.25);
  EXPECT_NEAR(bound.from_source, 0.25, 1e-9);
  EXPECT_EQ(bound.from_source, bound.to_source);
}

TEST(Certified, AnUnderstatedBoundIsFound) {
  // The tests above can fail: with the bounds halved, sampling finds points beyond them.
  const judge::Surface fine = test::as_surface(lab::make_sphere(12)), coarse = test::as_surface(lab::make_sphere(3));
  EXPECT_LT(0.5 * certify_one_step(fine, coarse).deviation, test::dense_truth(fine, coarse, 5000));
}

TEST(Certified, WhatIsNotANumberIsNoBound) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const judge::Surface fine = test::as_surface(lab::make_sphere(2)), coarse = test::as_surface(lab::make_sphere(1));
  // From below: one finer triangle whose bounds are not known.
  for (const double unknown : {nan, infinity}) {
    std::vector<TriangleBound> bounds = no_bounds(fine);
    bounds[3] = {unknown, unknown};
    EXPECT_EQ(certify_group(test::as_group(fine), bounds, test::as_group(coarse)).deviation, infinity);
    const TriangleBound first = initial_bound({{{0, 0, 0}, {1, 0, 0}, {0, 1, unknown}}}, {});
    EXPECT_EQ(first.from_source, infinity);
    EXPECT_EQ(first.to_source, infinity);
  }
  // From the geometry: squares that overflow.
  const judge::Surface huge = test::transformed(fine, 1e200, Vec3d(0.0));
  EXPECT_EQ(certify_one_step(huge, coarse).deviation, infinity);
  EXPECT_EQ(certify_one_step(coarse, huge).deviation, infinity);
}

TEST(Certified, NothingLeftIsInfinitelyFar) {
  const judge::Surface fine = test::as_surface(lab::make_sphere(2));
  EXPECT_EQ(certify_one_step(fine, {}).deviation, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace meshlode::builder
