// SPDX-License-Identifier: GPL-3.0-or-later
// The `measured` tier against closed forms and against the judge's dense sampling.
#include "builder/deviation/deviation.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <limits>

#include "builder/deviation/capsules.h"
#include "builder/deviation/group_measure.h"
#include "builder/deviation/surfaces.h"
#include "builder/odd_shapes.h"
#include "judge/metrics/triangle_tree.h"

namespace meshlode::builder {
namespace {

using test::Random;

TEST(Measured, AShiftedPlaneIsOffByItsShift) {
  const judge::Surface plane = test::as_surface(lab::make_plane(12));
  for (const double scale : {1e-6, 1.0, 1e9}) {
    const judge::Surface fine = test::transformed(plane, scale, Vec3d(0.0));
    const judge::Surface shifted = test::transformed(plane, scale, Vec3d(0.0, 0.125 * scale, 0.0));
    EXPECT_NEAR(test::measure_one_step(fine, shifted).deviation, 0.125 * scale, 1e-12 * scale);
    EXPECT_LE(test::measure_one_step(fine, fine).deviation, 1e-15 * scale);
  }
}

TEST(Measured, ACoarseSphereIsOffByItsSagitta) {
  const judge::Surface fine = test::as_surface(lab::make_sphere(40));
  const judge::Surface coarse = test::as_surface(lab::make_sphere(3));
  // A chord plane at distance h from the centre is 1 - h from the sphere: the largest triangle has the smallest h.
  double lowest = 1.0;
  for (const auto& t : coarse.triangles) {
    const Vec3d& a = coarse.positions[t[0]];
    const Vec3d n = glm::cross(coarse.positions[t[1]] - a, coarse.positions[t[2]] - a);
    lowest = std::min(lowest, std::abs(glm::dot(n, a)) / glm::length(n));
  }
  const double measured = test::measure_one_step(fine, coarse).deviation;
  EXPECT_LE(measured, (1.0 - lowest) * (1.0 + 1e-9));
  EXPECT_GE(measured, (1.0 - lowest) * 0.97);  // the fine sphere is itself inside the round one
}

TEST(Measured, ARemovedSpikeCostsItsHeight) {
  judge::Surface fine = test::as_surface(lab::make_plane(10));
  const judge::Surface coarse = test::as_surface(lab::make_plane(5));
  fine.positions[60].y += 0.375;  // an inner vertex
  EXPECT_NEAR(test::measure_one_step(fine, coarse).deviation, 0.375, 1e-12);
}

TEST(Measured, AClosedHoleCostsItsRadius) {
  // A square with a square hole, covered by a square without: the middle of the hole is half its width from the rim.
  judge::Surface fine = test::as_surface(lab::make_plane(12));
  std::erase_if(fine.triangles, [&](const auto& t) {
    const Vec3d c = (fine.positions[t[0]] + fine.positions[t[1]] + fine.positions[t[2]]) / 3.0;
    return std::abs(c.x) < 0.5 && std::abs(c.z) < 0.5;
  });
  const judge::Surface coarse = test::as_surface(lab::make_plane(1));
  const double measured = test::measure_one_step(fine, coarse).deviation;
  EXPECT_LE(measured, 0.5 + 1e-12);
  EXPECT_GE(measured, 0.5 * 0.95);
}

TEST(Measured, AClosedSliverOfAHoleCostsItsRadius) {
  // A hole that is ten times as long as wide, in two triangles that span it: no point spread over them lies in it.
  const double half = 0.1, high = 2.0;
  const std::vector<Vec3d> positions = {
      {0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}, {5, 4, 0}, {5 + 2 * half, 4, 0}, {5 + half, 4 + high, 0}};
  const judge::Surface fine{positions, {{0, 1, 5}, {0, 5, 4}, {1, 2, 5}, {5, 2, 6}, {6, 2, 3}, {6, 3, 4}, {4, 3, 0}}};
  const judge::Surface coarse{positions, {{0, 1, 2}, {0, 2, 3}}};
  const double side = std::sqrt(half * half + high * high);
  const double radius = half * high / (half + side);
  const std::vector<std::uint8_t> nothing_shared(positions.size(), 0);
  DeviationTierOptions options;
  options.finer_is_shared = nothing_shared;
  const double measured = test::measure_one_step(fine, coarse, options).deviation;
  EXPECT_LE(measured, radius * (1.0 + 1e-12));
  EXPECT_GE(measured, radius * 0.98);
}

TEST(Measured, ARemovedPieceIsAsFarAsItWas) {
  judge::Surface fine = test::as_surface(lab::make_sphere(4));
  const judge::Surface coarse = fine;
  const judge::Surface speck = test::transformed(test::as_surface(lab::make_cube(1)), 1e-3, Vec3d(3.0, 0.0, 0.0));
  const auto base = static_cast<std::uint32_t>(fine.positions.size());
  fine.positions.insert(fine.positions.end(), speck.positions.begin(), speck.positions.end());
  for (const auto& t : speck.triangles) fine.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  EXPECT_NEAR(test::measure_one_step(fine, coarse).deviation, test::dense_truth(fine, coarse), 1e-9);
}

TEST(Measured, LargeSourceTrianglesAreSeenInside) {
  // Two triangles folded along a diagonal against two along the other: the largest gap is inside, not at a corner.
  const std::vector<Vec3d> corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}};
  const judge::Surface fine{corners, {{0, 1, 2}, {0, 2, 3}}};
  const judge::Surface coarse{corners, {{0, 1, 3}, {1, 2, 3}}};
  const double truth = test::dense_truth(fine, coarse, 200000);
  const double measured = test::measure_one_step(fine, coarse).deviation;
  EXPECT_GE(measured, 0.98 * truth);
  EXPECT_LE(measured, 1.005 * truth);  // the samples miss some of it
}

TEST(Measured, WhatIsOfNoUseIsToldAsFarAsItIsKnown) {
  // Nothing reaches what is asked for: the deviation is what was found, not what was asked, and not a running maximum.
  const judge::Surface fine = test::as_surface(lab::make_sphere(12)), coarse = test::as_surface(lab::make_sphere(6));
  const double truth = test::dense_truth(fine, coarse);
  DeviationTierOptions options;
  options.floor = 0.7;
  options.least = 0.7;
  const double measured = test::measure_one_step(fine, coarse, options).deviation;
  EXPECT_LE(measured, truth * (1.0 + 1e-3));  // the oracle's samples may miss the top
  EXPECT_GE(measured, 0.8 * truth);
}

/// Every `nth` triangle of a soup.
judge::Surface part_of(const judge::Surface& soup, std::size_t nth) {
  judge::Surface part{soup.positions, {}};
  for (std::size_t t = 0; t < soup.triangles.size(); t += nth) part.triangles.push_back(soup.triangles[t]);
  return part;
}

TEST(Measured, ASoupIsSearchedToItsEndWhereTheGroupIsAllOfIt) {
  // Loose triangles of which most are gone, and samples of none but a few: nothing leads from them to the others.
  Random random(5);
  for (int round = 0; round < 8; ++round) {
    const judge::Surface fine = test::random_soup(random, 400, 1.0, 0.02 + 0.05 * round), coarse = part_of(fine, 8);
    const SourceTree source(fine.positions, fine.triangles);
    auto samples = initial_samples(source);
    std::erase_if(samples, [](const CarriedSample& sample) { return sample.triangle % 40 != 0; });
    DeviationTierOptions options;
    options.extra_effort = 3000;
    options.finer = test::as_group(coarse);
    options.is_whole = true;
    const double measured = measure_group(source, test::as_group(coarse), samples, options).deviation;
    EXPECT_GE(measured, test::dense_truth(fine, coarse) / 1.002) << "round " << round;
  }
}

TEST(Measured, OfALargeSourceTheWholeIsSearchedFromAbove) {
  // A quarter of a million triangles, no sample to lead to the one vertex that stands out, and as little effort as a
  // group among many gets: what is found is found from above.
  judge::Surface fine = test::as_surface(lab::make_plane(363));
  ASSERT_GT(fine.triangles.size(), 262144U);
  fine.positions[91234].y += 0.0625;
  const judge::Surface coarse = test::as_surface(lab::make_plane(3));
  const SourceTree source(fine.positions, fine.triangles);
  DeviationTierOptions options;
  options.finer = test::as_group(coarse);
  options.is_whole = true;
  EXPECT_NEAR(measure_group(source, test::as_group(coarse), {}, options).deviation, 0.0625, 1e-4);
}

TEST(Measured, EveryVertexIsASampleOfTheFirstTriangleThatHasIt) {
  // More triangles than are counted at a time, a vertex that none has, a triangle with one twice, and one that is long.
  judge::Surface surface = test::as_surface(lab::make_plane(70));
  ASSERT_GT(surface.triangles.size(), 2 * 4096U);
  surface.positions.emplace_back(9.0, 9.0, 9.0);
  surface.triangles[5][1] = surface.triangles[5][0];
  surface.positions[surface.triangles.back()[0]].y = 3.0;
  const SourceTree source(surface.positions, surface.triangles);
  std::vector<std::uint32_t> first_of(surface.positions.size(), kNoId);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    for (const std::uint32_t v : surface.triangles[t]) first_of[v] = std::min(first_of[v], t);
  }
  std::vector<std::uint32_t> sampled_at(surface.positions.size(), kNoId);
  std::uint32_t before = 0;
  std::size_t loose = 0;
  for (const CarriedSample& sample : initial_samples(source)) {
    EXPECT_GE(sample.triangle, before) << "in the order of triangles";
    before = sample.triangle;
    if (sample.vertex == kNoId) {
      ++loose;
      continue;
    }
    EXPECT_EQ(sample.point, surface.positions[sample.vertex]);
    EXPECT_EQ(sampled_at[sample.vertex], kNoId) << "once";
    sampled_at[sample.vertex] = sample.triangle;
  }
  EXPECT_EQ(sampled_at, first_of);
  EXPECT_GT(loose, 10U) << "along the long one";
}

TEST(Measured, APeakBetweenNeedlesIsFoundThoughNoPointNearItTells) {
  // Large triangles over a thicket of needles: the farthest point from all of them is the middle of the widest gap.
  Random random(6);
  for (int round = 0; round < 8; ++round) {
    judge::Surface fine;
    for (std::uint32_t i = 0; i < 60; ++i) {
      const Vec3d at(random.signed_unit(), 0.0, random.signed_unit());
      const Vec3d along = 0.3 * Vec3d(random.signed_unit(), 0.0, random.signed_unit());
      for (const Vec3d& p : {at, at + along, at + 0.5 * along + Vec3d(0.0, 1e-5, 0.0)}) fine.positions.push_back(p);
      fine.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const judge::Surface coarse = test::as_surface(lab::make_plane(2));
    DeviationTierOptions options;
    options.extra_effort = 3000;
    options.is_whole = true;
    EXPECT_GE(test::measure_one_step(fine, coarse, options).deviation, test::dense_truth(fine, coarse, 100000) / 1.005)
        << "round " << round;
  }
}

/// Stairs over the unit square along x: treads and risers of two triangles each.
judge::Surface make_stairs(Random& random, std::uint32_t steps) {
  judge::Surface stairs;
  double x = 0.0, height = 0.0;
  const auto add = [&](double x1, double height1) {
    const auto first = static_cast<std::uint32_t>(stairs.positions.size());
    for (const double z : {0.0, 1.0}) {
      stairs.positions.push_back({x, height, z});
      stairs.positions.push_back({x1, height1, z});
    }
    stairs.triangles.push_back({first, first + 1, first + 3});
    stairs.triangles.push_back({first, first + 3, first + 2});
    x = x1;
    height = height1;
  };
  for (std::uint32_t step = 0; step < steps; ++step) {
    add(x + (0.4 + 1.2 * random.unit()) / steps, height);
    add(x, height + 0.3 * random.signed_unit());
  }
  return stairs;
}

/// A sheet over x from 0 to `length`, z from 0 to 1, its corners at the height of their x.
template <class Height>
judge::Surface make_sheet(double length, std::uint32_t along, std::uint32_t across, const Height& height) {
  judge::Surface sheet;
  for (std::uint32_t i = 0; i <= along; ++i) {
    const double x = length * i / along;
    for (std::uint32_t j = 0; j <= across; ++j) {
      sheet.positions.push_back({x, height(x), static_cast<double>(j) / across});
    }
  }
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t a = i * (across + 1) + j, b = a + across + 1;
      sheet.triangles.push_back({a, b, b + 1});
      sheet.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return sheet;
}

// Between the points of a triangle that goes from one tread to the next the distance has narrow peaks, and little of
// the effort is spent where the first rise promises something: what is left finds more of them, and never less.
TEST(Measured, EffortThatIsLeftFindsPeaksBesideRisers) {
  Random random(9);
  int more = 0;
  for (int round = 0; round < 600; ++round) {
    const judge::Surface stairs = make_stairs(random, 3 + static_cast<std::uint32_t>(random.below(12)));
    const auto height = [&](double x) {
      double at = 0.0;
      for (const auto& t : stairs.triangles) {
        const Vec3d &a = stairs.positions[t[0]], &b = stairs.positions[t[1]];
        if (a.y == b.y && a.x <= x && x <= b.x) at = a.y;
      }
      return at;
    };
    const auto along = 5 + static_cast<std::uint32_t>(random.below(20));
    judge::Surface sheet =
        make_sheet(stairs.positions.back().x, along, 5 + static_cast<std::uint32_t>(random.below(20)), height);
    for (Vec3d& p : sheet.positions) {  // a net of its own: askew, its corners on the stairs
      p.x += 0.5 * random.unit() / along;
      p.z += 0.5 * random.unit() / 10.0;
      p.y = height(p.x);
    }
    SurfaceTree tree;
    tree.build({stairs.positions, stairs.triangles});
    const GroupSurface group = test::as_group(sheet);
    const GroupEdges edges(group);
    const auto found = [&](const Rise& rise) {
      std::vector<TreeSlot> places(sheet.triangles.size());
      std::vector<CarriedSample> high;
      return measure_to_source(tree, group, edges, places, {}, {300, 0, rise}, high).found;
    };
    const double first_alone = found({kUsualRise.first, kUsualRise.first}), both = found(kUsualRise);
    EXPECT_GE(both, first_alone) << "seed 9, round " << round;
    more += both > 1.001 * first_alone ? 1 : 0;
  }
  EXPECT_GE(more, 1) << "of 600";
}

// A sheet under a roof of two large triangles: where it does not cross the ridge it is near one of them. By bounds
// alone, whatever is known: what is beyond is found, to the margin and a percent that the effort may leave, and nothing
// where nothing is.
TEST(Measured, BoundsLeaveNothingBeyond) {
  Random random(10);
  for (int round = 0; round < 12; ++round) {
    const double ridge = random.between(0.2, 0.8), left = random.between(0.2, 1.0), right = random.between(0.2, 1.0);
    const judge::Surface roof{
        {{ridge, 0, -20}, {ridge, 0, 21}, {ridge - 20, -20 * left, 0.5}, {ridge + 20, -20 * right, 0.5}},
        {{0, 1, 2}, {0, 1, 3}}};
    const auto height = [&](double x) { return x < ridge ? left * (x - ridge) : right * (ridge - x); };
    const auto along = 8 + static_cast<std::uint32_t>(random.below(30));
    judge::Surface sheet = make_sheet(1.0, along, 2 + static_cast<std::uint32_t>(random.below(9)), height);
    for (Vec3d& p : sheet.positions) p.y -= 0.05 * std::min(left, right) * random.unit() / along;  // no two peaks alike
    SurfaceTree tree;
    tree.build({roof.positions, roof.triangles});
    const double truth = judge::DeviationFrom(roof, {.samples = 400000}).measure(sheet).b_to_a.max;
    const std::vector<TreeSlot> places(sheet.triangles.size());
    const auto found = [&](const Farthest& known) {
      return search_by_bounds(tree, test::as_group(sheet), places, 1.02, known).found;
    };
    for (const double share : {0.7, 0.8, 0.9, 0.98}) {
      EXPECT_GE(found({share * truth, 0.0}), truth / 1.03) << "seed 10, round " << round << ", from " << share;
    }
    EXPECT_EQ(found({1.01 * truth, 0.0}), 1.01 * truth);
    EXPECT_EQ(found({0.0, 1.01 * truth}), 0.0) << "nothing that is of no use";
  }
}

TEST(Measured, NothingLeftIsInfinitelyFar) {
  const judge::Surface fine = test::as_surface(lab::make_sphere(2));
  EXPECT_EQ(test::measure_one_step(fine, {}).deviation, std::numeric_limits<double>::infinity());
}

TEST(Measured, DegenerateTrianglesAreSegmentsAndPoints) {
  const judge::Surface fine{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  const judge::Surface point{{{0, 3, 0}}, {{0, 0, 0}}};
  EXPECT_NEAR(test::measure_one_step(fine, point).deviation, std::sqrt(13.0), 1e-12);
  EXPECT_NEAR(test::measure_one_step(point, fine).deviation, std::sqrt(13.0), 1e-12);
  EXPECT_TRUE(std::isfinite(test::measure_one_step(test::as_surface(lab::make_zero_areas(6)), point).deviation));
}

TEST(Measured, RandomSimplificationsAreWithinFivePercentOfTheDenseTruth) {
  Random random(11);
  int short_count = 0, count = 0;
  for (int round = 0; round < 24; ++round) {
    scene::Primitive shape;
    scene::Primitive simple;
    const auto n = static_cast<std::uint32_t>(3 + random.below(4));
    switch (round % 4) {
      case 0: shape = lab::make_sphere(4 * n), simple = lab::make_sphere(n); break;
      case 1: shape = lab::make_torus(12 * n, 8 * n), simple = lab::make_torus(3 * n, 2 * n); break;
      case 2: shape = lab::make_rock(6 * n, 7), simple = lab::make_rock(2 * n, 7); break;
      default: shape = lab::make_terrain(12 * n, 9 * n, 11), simple = lab::make_terrain(4 * n, 3 * n, 11); break;
    }
    judge::Surface fine = test::as_surface(shape), coarse = test::as_surface(simple);
    for (Vec3d& p : coarse.positions) {
      p += 0.02 * Vec3d(random.signed_unit(), random.signed_unit(), random.signed_unit());
    }
    const double truth = test::dense_truth(fine, coarse);
    const double measured = test::measure_one_step(fine, coarse).deviation;
    EXPECT_GE(measured, 0.95 * truth) << "round " << round;
    EXPECT_LE(measured, truth * 1.1) << "round " << round;  // the oracle's own samples miss some of it
    short_count += measured < truth ? 1 : 0;
    ++count;
  }
  EXPECT_LE(short_count, count / 4);
}

TEST(Measured, SamplesAreThinnedButTheFarthestStay) {
  const judge::Surface fine = test::as_surface(lab::make_rock(24)), coarse = test::as_surface(lab::make_rock(6));
  const SourceTree source(fine.positions, fine.triangles);
  const auto samples = initial_samples(source);
  const GroupDeviation result = measure_group(source, test::as_group(coarse), samples, {});
  EXPECT_LT(result.carried.size(), samples.size());
  float farthest = 0.0F;
  for (const CarriedSample& sample : result.carried) {
    ASSERT_LT(sample.triangle, coarse.triangles.size());
    const auto& t = coarse.triangles[sample.triangle];
    const double truth = std::sqrt(judge::distance2_to_triangle(sample.point, coarse.positions[t[0]],
                                                                coarse.positions[t[1]], coarse.positions[t[2]]));
    EXPECT_NEAR(sample.distance, truth, 1e-6);
    farthest = std::max(farthest, sample.distance);
  }
  EXPECT_GE(static_cast<double>(farthest), 0.9 * result.deviation);
}

TEST(Measured, AChainOfLevelsKeepsWhatTheFirstHad) {
  // A thin spike on a fine sphere must still be measured when the third coarser sphere has long lost it.
  judge::Surface fine = test::as_surface(lab::make_sphere(32));
  fine.positions[1234] *= 1.5;
  const SourceTree source(fine.positions, fine.triangles);
  auto samples = initial_samples(source);
  for (const std::uint32_t n : {16U, 8U, 4U, 2U}) {
    const judge::Surface coarse = test::as_surface(lab::make_sphere(n));
    GroupDeviation result = measure_group(source, test::as_group(coarse), samples, {});
    EXPECT_GE(result.deviation, 0.999 * test::dense_truth(fine, coarse)) << n;
    samples = std::move(result.carried);
  }
}

TEST(Measured, TheSourcesOwnBorderBelongsToTheGroup) {
  // A strip with a spike on its open border, which the levels before have flattened to half of it. No sample sits on
  // the tip. Where the border is shared with another group its points stay as near as they are, and nobody looks.
  const auto strip = [](double spike) {
    judge::Surface surface;
    for (int i = 0; i <= 4; ++i) {
      surface.positions.emplace_back(i, 0.0, 0.0);
      surface.positions.emplace_back(i, i == 2 ? 1.0 + spike : 1.0, 0.0);
    }
    for (std::uint32_t i = 0; i < 8; i += 2) {
      surface.triangles.push_back({i, i + 2, i + 1});
      surface.triangles.push_back({i + 1, i + 2, i + 3});
    }
    return surface;
  };
  const judge::Surface exact = strip(0.2), finer = strip(0.1), group = strip(0.0);
  const SourceTree source(exact.positions, exact.triangles);
  auto samples = initial_samples(source);
  std::erase_if(samples, [](const CarriedSample& sample) { return sample.point.y > 1.15; });
  const std::vector<std::uint8_t> nothing(finer.positions.size(), 0), everything(finer.positions.size(), 1);
  const auto measure = [&](std::span<const std::uint8_t> is_shared) {
    return measure_group(source, test::as_group(group), samples,
                         {.floor = 0.1, .finer = test::as_group(finer), .finer_is_shared = is_shared})
        .deviation;
  };
  EXPECT_NEAR(measure(nothing), 0.2, 1e-12);
  EXPECT_LT(measure(everything), 0.15);
  EXPECT_EQ(measure({}), measure(everything));
}

TEST(Measured, SeamsDoNotStopTheSearch) {
  // The same sphere with a vertex of its own for every corner: what is found must not depend on it.
  scene::Primitive shape = lab::make_sphere(24);
  shape.positions[500] *= 1.25;
  const judge::Surface coarse = test::as_surface(lab::make_sphere(4));
  const judge::Surface whole = test::as_surface(shape), split = test::as_surface(lab::with_split_normals(shape));
  const GroupDeviation a = test::measure_one_step(whole, coarse), b = test::measure_one_step(split, coarse);
  EXPECT_NEAR(a.deviation, b.deviation, 1e-3 * a.deviation);
  EXPECT_NEAR(a.deviation, 0.25, 0.03);
  const SourceTree tree(split.positions, split.triangles);
  EXPECT_EQ(initial_samples(tree).size(), initial_samples(SourceTree(whole.positions, whole.triangles)).size());
}

TEST(Measured, AHubHidesNoPeakOfItsRim) {
  // No search goes on through the hub: what lies beside its triangles is found along the rim, and from the samples.
  constexpr std::uint32_t kCount = 4000, kStep = 8;
  static_assert(kCount / kStep >= kHubTriangles, "the coarse one has a hub, too");
  judge::Surface fine = test::as_surface(test::make_fan(kCount));
  for (std::uint32_t i = 0; i < kCount; ++i) fine.positions[i + 1].y += i % kStep == 0 ? 0.0 : 0.001 * (i % kStep);
  fine.positions[2003].y = -0.02;
  judge::Surface coarse = fine;
  coarse.triangles.clear();
  for (std::uint32_t i = 0; i < kCount; i += kStep) coarse.triangles.push_back({0, i + 1, (i + kStep) % kCount + 1});
  const double truth = test::dense_truth(fine, coarse);
  EXPECT_NEAR(truth, 0.02, 0.001);
  EXPECT_NEAR(test::measure_one_step(fine, coarse).deviation, truth, 0.002 * truth);
}

TEST(Measured, TheSameBitsForAnyThreadCount) {
  const judge::Surface fine = test::as_surface(lab::make_rock(60)), coarse = test::as_surface(lab::make_rock(20));
  const auto measure = [&](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return test::measure_one_step(fine, coarse);
  };
  const GroupDeviation one = measure(1);
  for (const std::size_t threads : {2U, 4U}) {
    const GroupDeviation other = measure(threads);
    EXPECT_EQ(one.deviation, other.deviation);
    ASSERT_EQ(one.carried.size(), other.carried.size());
    for (std::size_t i = 0; i < one.carried.size(); ++i) {
      EXPECT_EQ(one.carried[i].point, other.carried[i].point);
      EXPECT_EQ(one.carried[i].triangle, other.carried[i].triangle);
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
