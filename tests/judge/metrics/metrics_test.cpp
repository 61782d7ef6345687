// SPDX-License-Identifier: GPL-3.0-or-later
// Distances against closed forms, brute force and CGAL.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>

#include "judge/metrics/area_samples.h"
#include "judge/metrics/cgal_distance.h"
#include "judge/metrics/metrics.h"
#include "judge/metrics/shaded_surface.h"
#include "judge/metrics/triangle_tree.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

using test::RandomSource;

// A square of side `size` in the plane z = height, as 2·n·n triangles.
Surface make_square(double size, double height, std::uint32_t n) {
  Surface s;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) s.positions.push_back({size * x / n, size * y / n, height});
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      s.triangles.push_back({a, b, d});
      s.triangles.push_back({a, d, c});
    }
  }
  return s;
}

Surface make_soup(RandomSource& random, std::uint32_t count, double size, const Vec3d& offset) {
  Surface s;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d at = offset + random.in_cube(size);
    const double edge = size * random.log_between(1e-4, 1.0);
    for (int k = 0; k < 3; ++k) s.positions.push_back(at + random.in_cube(edge));
    s.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return s;
}

TEST(Metrics, DistanceToATriangleHasItsClosedFormOverFaceEdgeAndCorner) {
  const Vec3d a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({1, 1, 3}, a, b, c), 9.0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({1, 1, -3}, a, c, b), 9.0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({2, -3, 4}, a, b, c), 25.0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({7, 0, 4}, a, b, c), 25.0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({4, 4, 0}, a, b, c), 8.0);
  EXPECT_EQ(distance2_to_triangle({1, 1, 0}, a, b, c), 0.0);
}

// Whatever rounds: a point that was measured is near where its distance says so.
TEST(Metrics, IsNearATriangleExactlyWhereItsDistanceSaysSo) {
  RandomSource random(53);
  std::size_t over = 0;
  for (int i = 0; i < 60000; ++i) {
    const Vec3d offset = random.in_cube(random.log_between(1e-3, 1e6));
    const Vec3d a = offset + random.in_cube(1.0), b = offset + random.in_cube(1.0);
    const Vec3d c = i % 2 == 0
                        ? offset + random.in_cube(1.0)
                        : a + (b - a) * random.between(0.0, 1.0) + random.in_cube(random.log_between(1e-6, 1e-1));
    const Vec3d on = (a + b * random.between(0.0, 2.0) + c * random.between(0.0, 2.0)) * 0.25 + a * 0.25;
    const Vec3d p = on + random.in_cube(random.log_between(1e-13, 1.0));
    const double d2 = distance2_to_triangle(p, a, b, c);
    over += d2 > 0.0 ? 1 : 0;
    EXPECT_TRUE(is_near_triangle(p, a, b, c, d2)) << i;
    EXPECT_TRUE(is_near_triangle(p, a, b, c, d2 * (1.0 + 1e-7) + 1e-300)) << i;
    EXPECT_FALSE(is_near_triangle(p, a, b, c, d2 - std::max(d2 * 1e-15, 1e-300))) << i;
    EXPECT_FALSE(is_near_triangle(p, a, b, c, d2 * 0.9 - 1e-300)) << i;
  }
  EXPECT_GT(over, 50000U);
}

TEST(Metrics, DistanceToNeedlesSegmentsAndPointsIsThatToWhatTheyAre) {
  EXPECT_DOUBLE_EQ(distance2_to_triangle({1, 2, 0}, {0, 0, 0}, {2, 0, 0}, {4, 0, 0}), 4.0);
  EXPECT_DOUBLE_EQ(distance2_to_triangle({1, 2, 2}, {1, 0, 2}, {1, 0, 2}, {1, 0, 2}), 4.0);
  EXPECT_NEAR(distance2_to_triangle({0.5, 0, 3}, {0, 0, 0}, {1, 0, 0}, {0.5, 1e-12, 0}), 9.0, 1e-9);
  RandomSource random(51);
  for (int i = 0; i < 20000; ++i) {  // a needle is never nearer than its bounding segment says
    const Vec3d a = random.in_cube(1.0), b = a + random.direction();
    const double width = random.log_between(1e-17, 1e-2);
    const Vec3d c = a + (b - a) * random.unit() + random.direction() * width;
    const Vec3d p = random.in_cube(3.0);
    const double to_segment = std::sqrt(distance2_to_triangle(p, a, b, a));
    EXPECT_NEAR(std::sqrt(distance2_to_triangle(p, a, b, c)), to_segment, width + 1e-7);
  }
}

TEST(Metrics, NearestPointsAgreeWithCgalAtAnySizeAndOffset) {
  RandomSource random(52);
  for (const double size : {1e-6, 1.0, 1e9}) {
    for (const double offset : {0.0, 1e6}) {
      const Surface s = make_soup(random, 2000, size, random.direction() * (offset * size));
      const TriangleTree tree(s);
      const test::CgalDistance oracle(s);
      std::uint32_t hint = 0xFFFFFFFFu;
      for (int i = 0; i < 3000; ++i) {
        const Vec3d p = s.positions[random.below(6000)] + random.in_cube(size * random.log_between(1e-6, 10.0));
        const NearestPoint nearest = tree.nearest(p, hint);
        EXPECT_EQ(nearest.distance2, tree.nearest(p).distance2) << "a hint changes no result";
        EXPECT_EQ(tree.any_within(nearest.distance2, p, hint).triangle, kNoId) << "nothing is nearer";
        const double more = 1.1 * nearest.distance2 + 1e-18 * size * size * (1.0 + offset * offset);
        const NearestPoint within = tree.any_within(more, p, hint);
        ASSERT_NE(within.triangle, kNoId);
        EXPECT_LT(within.distance2, more);
        hint = nearest.triangle;
        const double expected = std::sqrt(oracle.distance2(p));
        EXPECT_NEAR(std::sqrt(nearest.distance2), expected, 1e-6 * expected + 1e-9 * size * (1.0 + 1e-6 * offset))
            << "seed 52";
      }
    }
  }
}

TEST(Metrics, NearestIsTheSmallestOverAllTrianglesIncludingDegenerateOnes) {
  RandomSource random(53);
  Surface s = make_soup(random, 200, 1.0, Vec3d(0.0));
  for (std::size_t t = 0; t < s.triangles.size(); t += 5) s.triangles[t][2] = s.triangles[t][random.below(2)];
  const TriangleTree tree(s);
  for (int i = 0; i < 3000; ++i) {
    const Vec3d p = random.in_cube(2.0);
    double expected = std::numeric_limits<double>::infinity();
    for (const auto& t : s.triangles) {
      expected = std::min(expected, distance2_to_triangle(p, s.positions[t[0]], s.positions[t[1]], s.positions[t[2]]));
    }
    EXPECT_EQ(tree.nearest(p).distance2, expected);
  }
}

/// A triangle across the unit cube; at its sharpest corner a sine that may be tiny.
std::array<Vec3d, 3> make_crossing(RandomSource& random, const Vec3d& offset) {
  const Vec3d a = random.in_cube(1.0), b = random.in_cube(1.0);
  const Vec3d beside = glm::cross(b - a, random.direction()) * random.log_between(1e-9, 1.0);
  return {offset + a, offset + b, offset + a + (b - a) * random.unit() + beside};
}

// A triangle is dismissed where its plane is too far: not one that is the nearest, to the last bit. Points lie on and
// near the planes, needles' too, far from the origin too.
TEST(Metrics, NearestAmongTrianglesThatCrossIsTheSmallestOverAll) {
  RandomSource random(58);
  for (const double offset : {0.0, 1e6}) {
    for (const double size : {1e-9, 1.0, 1e9}) {
      Surface s;
      const Vec3d center = random.direction() * offset;
      for (std::uint32_t i = 0; i < 300; ++i) {
        for (const Vec3d& p : make_crossing(random, center)) s.positions.push_back(p * size);
        s.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      }
      const TriangleTree tree(s);
      const auto corners_of = [&](std::size_t t) {
        return std::array<Vec3d, 3>{s.positions[3 * t], s.positions[3 * t + 1], s.positions[3 * t + 2]};
      };
      for (int i = 0; i < 2000; ++i) {
        const std::array<Vec3d, 3> corner = corners_of(random.below(300));
        const double u = random.unit(), v = random.unit() * (1.0 - u);
        const Vec3d p = corner[0] + (corner[1] - corner[0]) * u + (corner[2] - corner[0]) * v +
                        random.direction() * (size * random.log_between(1e-17, 1.0));
        double expected = std::numeric_limits<double>::infinity();
        std::set<std::uint32_t> within;
        const double reach2 = size * size * random.log_between(1e-20, 1.0);
        for (std::uint32_t t = 0; t < 300; ++t) {
          const std::array<Vec3d, 3> at = corners_of(t);
          const double d = distance2_to_triangle(p, at[0], at[1], at[2]);
          expected = std::min(expected, d);
          if (d <= reach2) within.insert(t);
        }
        EXPECT_EQ(tree.nearest(p).distance2, expected) << "seed 58, offset " << offset << ", size " << size;
        std::vector<NearestPoint> found;
        tree.find_within(p, reach2, found);
        std::set<std::uint32_t> names;
        for (const NearestPoint& one : found) names.insert(one.triangle);
        EXPECT_EQ(names, within);
      }
    }
  }
}

TEST(Metrics, TreesThatSeveralThreadsMakeAreComplete) {
  RandomSource random(57);
  for (const std::uint32_t count : {1U, 4U, 5U, 8191U, 8192U, 30001U}) {
    const Surface s = make_soup(random, count, 1.0, Vec3d(0.0));
    std::vector<Vec3d> points;
    std::vector<double> expected;
    for (int i = 0; i < 40; ++i) {
      points.push_back(random.in_cube(1.5));
      expected.push_back(std::numeric_limits<double>::infinity());
      for (const auto& t : s.triangles) {
        const double there =
            distance2_to_triangle(points.back(), s.positions[t[0]], s.positions[t[1]], s.positions[t[2]]);
        expected.back() = std::min(expected.back(), there);
      }
    }
    for (const int threads : {1, 4}) {
      for (const auto positions : {TriangleTree::Positions::kCopied, TriangleTree::Positions::kShared}) {
        tbb::task_arena(threads).execute([&] {
          const TriangleTree tree(s, positions);
          for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(tree.nearest(points[i]).distance2, expected[i]);
        });
      }
    }
  }
}

/// Spokes of a wheel that lies askew, and loose needles: triangles that fill next to nothing of their boxes.
Surface make_spokes(RandomSource& random, std::uint32_t count, double offset) {
  Surface s;
  const Vec3d hub = random.direction() * offset;
  const Vec3d u = random.direction(), v = random.direction();
  s.positions.push_back(hub);
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 6.283185307179586 * i / count;
    s.positions.push_back(hub + u * std::cos(angle) + v * std::sin(angle));
    s.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(s.positions.size());
    const Vec3d a = hub + random.in_cube(1.0), b = a + random.in_cube(1.0);
    const double width = random.log_between(1e-9, 1e-2);
    for (const Vec3d& p : {a, b, a + random.in_cube(width)}) s.positions.push_back(p);
    s.triangles.push_back({first, first + 1, first + (i % 7 == 0 ? 1 : 2)});
  }
  return s;
}

TEST(Metrics, TrianglesInSeveralLeavesAreFoundOnceAndAtTheirDistance) {
  RandomSource random(54);
  for (const double offset : {0.0, 1e6}) {
    const Surface s = make_spokes(random, 300, offset);
    const TriangleTree tree(s);
    for (int i = 0; i < 1000; ++i) {
      const Vec3d p = s.positions[random.below(static_cast<std::uint32_t>(s.positions.size()))] +
                      random.in_cube(random.log_between(1e-9, 2.0));
      const double reach2 = random.log_between(1e-6, 1.0);
      std::set<std::uint32_t> within;
      double expected = std::numeric_limits<double>::infinity();
      for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
        const auto& ids = s.triangles[t];
        const double d = distance2_to_triangle(p, s.positions[ids[0]], s.positions[ids[1]], s.positions[ids[2]]);
        expected = std::min(expected, d);
        if (d <= reach2) within.insert(t);
      }
      EXPECT_EQ(tree.nearest(p).distance2, expected);
      std::vector<NearestPoint> found{{-1.0, 7}};
      tree.find_within(p, reach2, found);
      EXPECT_EQ(found[0].distance2, -1.0) << "appended";
      std::set<std::uint32_t> names;
      for (std::size_t k = 1; k < found.size(); ++k) EXPECT_TRUE(names.insert(found[k].triangle).second) << "twice";
      EXPECT_EQ(names, within);
    }
  }
}

TEST(Metrics, ATriangleThatCoversAnotherIsFoundWhereThereIsOne) {
  RandomSource random(56);
  for (const double offset : {0.0, 1e6}) {
    const Surface s = make_spokes(random, 300, offset);
    const TriangleTree tree(s);
    int covered = 0;
    for (int i = 0; i < 1000; ++i) {
      const auto& of = s.triangles[random.below(static_cast<std::uint32_t>(s.triangles.size()))];
      std::array<Vec3d, 3> part;
      for (Vec3d& p : part) {
        const double u = random.between(0.0, 0.5), v = random.between(0.0, 0.5);
        p = s.positions[of[0]] * (1.0 - u - v) + s.positions[of[1]] * u + s.positions[of[2]] * v +
            random.in_cube(i % 2 == 0 ? 1e-3 : 0.0);
      }
      const double reach2 = random.log_between(1e-8, 1e-3);
      const auto covers = [&](std::uint32_t t) {
        const auto& ids = s.triangles[t];
        return std::all_of(part.begin(), part.end(), [&](const Vec3d& p) {
          return distance2_to_triangle(p, s.positions[ids[0]], s.positions[ids[1]], s.positions[ids[2]]) <= reach2;
        });
      };
      bool is_any = false;
      for (std::uint32_t t = 0; t < s.triangles.size(); ++t) is_any = is_any || covers(t);
      const std::uint32_t found = tree.find_covering(part, reach2);
      EXPECT_EQ(found != kNoId, is_any);
      EXPECT_TRUE(found == kNoId || covers(found));
      covered += is_any ? 1 : 0;
    }
    EXPECT_GT(covered, 300);
    EXPECT_LT(covered, 950);
  }
}

TEST(Metrics, OneThatIsNearEnoughAtLastIsTakenAmongManyAlone) {
  // Edges along one line across their boxes, a tenth beside the point.
  const auto make_lines = [](std::uint32_t count) {
    Surface s;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double end = 1.0 + 1e-4 * i, beside = 0.1 + 1e-6 * i;
      s.positions.push_back({-end, -end + beside, -end});
      s.positions.push_back({end, end + beside, end});
      s.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 1});
    }
    return s;
  };
  const Surface few = make_lines(4), many = make_lines(5000);
  const TriangleTree tree_of_few(few), tree_of_many(many);
  const NearestPoint of_few = tree_of_few.near_enough(1.0, Vec3d(0.0), kNoId);
  EXPECT_TRUE(of_few.is_nearest);
  EXPECT_EQ(of_few.distance2, tree_of_few.nearest(Vec3d(0.0)).distance2);
  const NearestPoint of_many = tree_of_many.near_enough(1.0, Vec3d(0.0), kNoId);
  EXPECT_FALSE(of_many.is_nearest);
  EXPECT_LE(of_many.distance2, 1.0);
  const NearestPoint beyond = tree_of_many.near_enough(1e-3, Vec3d(0.0), kNoId);
  EXPECT_TRUE(beyond.is_nearest) << "none is within that";
  EXPECT_EQ(beyond.distance2, tree_of_many.nearest(Vec3d(0.0)).distance2);
}

// The hub's surroundings lie in the box of every fourth spoke. Without pieces a wheel takes a hundred times as long to
// search as a square of as many triangles, with them thirty times.
TEST(Metrics, TheHubOfAWheelIsNoTrap) {
  const auto seconds = [](const Surface& s) {
    const TriangleTree tree(s);
    const std::clock_t start = std::clock();
    double sum = 0.0;
    for (const auto& t : s.triangles) {
      for (const double at : {0.2, 0.4, 0.6, 0.8}) {
        sum += tree.nearest(s.positions[t[0]] + at * (s.positions[t[1]] - s.positions[t[0]])).distance2;
      }
    }
    EXPECT_LT(sum, 1e-12);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  RandomSource random(55);
  Surface wheel = make_spokes(random, 8000, 0.0);
  wheel.triangles.resize(8000);
  const double square = seconds(make_square(2.0, 0.0, 63));
  const double spokes = seconds(wheel);
  EXPECT_LT(spokes, 60.0 * std::max(square, 0.005));
}

TEST(Metrics, ParallelSquaresAreTheirDistanceApartBothWays) {
  const DeviationReport r = DeviationFrom(make_square(10.0, 0.0, 7), {20000, 1}).measure(make_square(10.0, 0.25, 3));
  for (const OneWayDeviation& d : {r.a_to_b, r.b_to_a}) {
    EXPECT_NEAR(d.max, 0.25, 1e-12);
    EXPECT_NEAR(d.rms, 0.25, 1e-12);
  }
  EXPECT_EQ(r.a_to_b.points, 20000U + 64U);
  EXPECT_EQ(r.b_to_a.points, 20000U + 16U);
}

TEST(Metrics, ASurfaceIsAtDistanceZeroFromItselfAndItsRefinement) {
  const DeviationReport r = DeviationFrom(make_square(10.0, 1.0, 2), {20000, 1}).measure(make_square(10.0, 1.0, 9));
  EXPECT_EQ(r.max(), 0.0);
  EXPECT_EQ(r.rms(), 0.0);
}

TEST(Metrics, AMissingPartIsSeenFromOneSideOnlyAndItsRmsIsTheIntegral) {
  // B is the left half: points of A at x > 5 are x - 5 away. rms² = ∫₅¹⁰ (x-5)² dx / 10 = 125/3/10.
  Surface half = make_square(10.0, 0.0, 10);
  for (Vec3d& p : half.positions) p.x *= 0.5;
  const DeviationReport r = DeviationFrom(make_square(10.0, 0.0, 10), {200000, 1}).measure(half);
  EXPECT_DOUBLE_EQ(r.a_to_b.max, 5.0);
  EXPECT_DOUBLE_EQ(r.a_to_b.worst.x, 10.0);
  EXPECT_NEAR(r.a_to_b.rms, std::sqrt(125.0 / 30.0), 1e-4);
  EXPECT_EQ(r.b_to_a.max, 0.0);
}

TEST(Metrics, SamplesAreUniformInAreaWhateverTheTriangles) {
  // One big triangle, and its mirror image cut into many: half the area each, so rms is that of a uniform cover.
  Surface s{{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}}, {{0, 1, 2}}};
  const Surface fine = make_square(8.0, 0.0, 40);
  const std::uint32_t base = 3;
  s.positions.insert(s.positions.end(), fine.positions.begin(), fine.positions.end());
  for (const auto& t : fine.triangles) {
    const Vec3d m = (fine.positions[t[0]] + fine.positions[t[1]] + fine.positions[t[2]]) / 3.0;
    if (m.y > m.x) s.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  Surface edge{{{0, 0, 0}, {0, 8, 0}, {0, 4, 0}}, {{0, 1, 2}}};  // the line x = 0: distance is x, rms = 8/√3
  EXPECT_NEAR(DeviationFrom(s, {200000, 3}).measure(edge).a_to_b.rms, 8.0 / std::sqrt(3.0), 5e-3);
}

TEST(Metrics, EmptyAndDegenerateSurfacesAreAnswered) {
  const Surface none, square = make_square(1.0, 0.0, 1);
  EXPECT_EQ(DeviationFrom(none, {}).measure(none).max(), 0.0);
  EXPECT_TRUE(std::isinf(DeviationFrom(square, {}).measure(none).a_to_b.max));
  EXPECT_EQ(DeviationFrom(square, {}).measure(none).b_to_a.max, 0.0);
  const Surface point{{{0, 0, 2}, {9, 9, 9}}, {{0, 0, 0}}};  // the second position is not used
  const DeviationReport r = DeviationFrom(point, {1000, 1}).measure(square);
  EXPECT_DOUBLE_EQ(r.a_to_b.max, 2.0);
  EXPECT_DOUBLE_EQ(r.b_to_a.max, std::sqrt(6.0));
}

TEST(Metrics, TheSourceIsItsTrianglesWithArea) {
  scene::SourceMesh mesh;
  scene::Primitive& shape = mesh.primitives.emplace_back();
  shape.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {9, 0, 0}, {9, 1e-300, 0}, {5, 0, 0}};
  shape.indices = {0, 1, 2, 0, 3, 4, 0, 4, 4, 0, 6, 4, 0, 4, 5};
  const Surface source = surface_of_source(mesh);
  ASSERT_EQ(source.triangles.size(), 2U) << "a repeated corner, one place twice, a line; a sliver has area";
  EXPECT_EQ(source.triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(source.triangles[1], (std::array<std::uint32_t, 3>{0, 4, 5}));
  EXPECT_EQ(shaded_surface_of_source(mesh).surface.triangles.size(), 2U);
}

/// What is painted is looked for on what draws nothing too, where it lies along edges: of the triangles on lines one
/// has both of its parts covered by edges of others, one has not.
TEST(Metrics, WhatIsPaintedLiesOnTrianglesWithoutAreaTooButIsNotAskedAboutThere) {
  scene::SourceMesh mesh;
  scene::Primitive& shape = mesh.primitives.emplace_back();
  shape.positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 0, 0}, {0, -2, 0}, {9, 0, 0}};
  shape.indices = {0, 1, 2, 0, 3, 4, 3, 1, 4, 0, 3, 1, 0, 3, 5};
  shape.uvs[0].assign(6, Vec2f(0.0F));
  shape.uvs[0][3] = Vec2f(100.0F, 0.0F);  // of all three that meet there
  const ShadedSurface painted = painted_surface_of_source(mesh);
  ASSERT_EQ(painted.surface.triangles.size(), 4U);
  EXPECT_EQ(painted.undrawn, 1U);
  EXPECT_EQ(painted.surface.triangles.size(),
            painted.undrawn + shaded_surface_of_source(mesh).surface.triangles.size());
  EXPECT_EQ(used_vertices(painted.surface, 1).size(), 3U);
  EXPECT_EQ(used_vertices(painted.surface).size(), used_vertices(painted.surface, 4).size());
}

TEST(Metrics, DoesNotDependOnTheNumberOfThreads) {
  RandomSource random(54);
  const Surface a = make_soup(random, 3000, 1.0, Vec3d(0.0)), b = make_soup(random, 3000, 1.0, Vec3d(0.1));
  DeviationReport one, two;
  tbb::task_arena(1).execute([&] { one = DeviationFrom(a, {20000, 9}).measure(b); });
  tbb::task_arena(2).execute([&] { two = DeviationFrom(a, {20000, 9}).measure(b); });
  EXPECT_EQ(one.a_to_b.max, two.a_to_b.max);
  EXPECT_EQ(one.a_to_b.rms, two.a_to_b.rms);
  EXPECT_EQ(one.b_to_a.rms, two.b_to_a.rms);
  EXPECT_NE(one.a_to_b.rms, DeviationFrom(a, {20000, 10}).measure(b).a_to_b.rms) << "the seed is used";
}

}  // namespace
}  // namespace meshlode::judge
