// SPDX-License-Identifier: GPL-3.0-or-later
// Brackets of a distance against closed forms, and against dense samples of soups.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <numeric>

#include "judge/metrics/missed_peaks.h"
#include "judge/metrics/surface_bracket.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

using test::RandomSource;

Bracket bracket(const Surface& a, const Surface& b, const BracketOptions& options) {
  const TriangleTree tree(b);
  std::vector<std::uint32_t> all(a.triangles.size());
  std::iota(all.begin(), all.end(), 0U);
  return bracket_one_way(a, all, {b, tree}, options);
}

Bracket bracket(const Surface& a, const Surface& b) {
  return bracket(a, b, {.enough = 1e-9, .budget = 1000000});
}

Surface triangles_of(const std::vector<std::array<Vec3d, 3>>& triangles) {
  Surface s;
  for (const auto& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(s.positions.size());
    s.positions.insert(s.positions.end(), triangle.begin(), triangle.end());
    s.triangles.push_back({first, first + 1, first + 2});
  }
  return s;
}

/// A rectangle [x0, x1] x [-1, 1] with a slope in x, of two triangles.
void add_slope(std::vector<std::array<Vec3d, 3>>& out, double x0, double z0, double x1, double z1) {
  out.push_back({Vec3d{x0, -1, z0}, Vec3d{x1, -1, z1}, Vec3d{x1, 1, z1}});
  out.push_back({Vec3d{x0, -1, z0}, Vec3d{x1, 1, z1}, Vec3d{x0, 1, z0}});
}

Surface make_sphere(std::uint32_t n) {
  Surface s;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x < 2 * n; ++x) {
      const double u = M_PI * y / n, v = M_PI * x / n;
      s.positions.push_back({std::sin(u) * std::cos(v), std::sin(u) * std::sin(v), std::cos(u)});
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < 2 * n; ++x) {
      const std::uint32_t a = y * 2 * n + x, b = y * 2 * n + (x + 1) % (2 * n), c = a + 2 * n, d = b + 2 * n;
      if (y > 0) s.triangles.push_back({a, c, b});
      if (y + 1 < n) s.triangles.push_back({b, c, d});
    }
  }
  return s;
}

Surface make_box(double half) {
  Surface s;
  for (int i = 0; i < 8; ++i) {
    s.positions.push_back({(i & 1) != 0 ? half : -half, (i & 2) != 0 ? half : -half, (i & 4) != 0 ? half : -half});
  }
  s.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  return s;
}

Surface make_soup(RandomSource& random, std::uint32_t count, const Vec3d& offset) {
  std::vector<std::array<Vec3d, 3>> out;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d at = offset + random.in_cube(1.0);
    const double edge = random.log_between(1e-2, 1.0);
    std::array<Vec3d, 3> t;
    for (Vec3d& p : t) p = at + random.in_cube(edge);
    if (i % 5 == 1) t[2] = t[0] + (t[1] - t[0]) * 0.3;                                // a segment
    if (i % 5 == 2) t[2] = t[0] + (t[1] - t[0]) * 0.6 + random.in_cube(1e-7 * edge);  // a needle
    if (i % 25 == 3) t[1] = t[2] = t[0];                                              // a point
    out.push_back(t);
  }
  return triangles_of(out);
}

/// The largest of the distances at a grid of points on each triangle.
double sampled(const Surface& a, const Surface& b, std::uint32_t n) {
  double most = 0.0;
  for (const auto& t : a.triangles) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      for (std::uint32_t j = 0; i + j <= n; ++j) {
        const Vec3d p = a.positions[t[0]] + (a.positions[t[1]] - a.positions[t[0]]) * (double(i) / n) +
                        (a.positions[t[2]] - a.positions[t[0]]) * (double(j) / n);
        double least = HUGE_VAL;
        for (const auto& k : b.triangles) {
          least = std::min(least, distance2_to_triangle(p, b.positions[k[0]], b.positions[k[1]], b.positions[k[2]]));
        }
        most = std::max(most, std::sqrt(least));
      }
    }
  }
  return most;
}

void expect_truth(const Bracket& found, double truth, double rounding = 1e-9) {
  EXPECT_LE(found.lower, truth + rounding);
  EXPECT_GE(found.upper, truth - rounding);
  EXPECT_LE(found.upper, found.lower * 1.003 + 2e-9);
  EXPECT_EQ(found.undecided, 0U);
}

TEST(SurfaceBracket, OfEqualSurfacesIsNothing) {
  const Surface s = make_sphere(24);
  const Bracket found = bracket(s, s);
  EXPECT_LE(found.lower, 1e-15);
  EXPECT_LE(found.upper, 1e-9);
}

TEST(SurfaceBracket, FindsTheMiddleOfAGapUnderATriangle) {
  std::vector<std::array<Vec3d, 3>> sheets;
  add_slope(sheets, -9, 0, -0.125, 0);
  add_slope(sheets, 0.125, 0, 9, 0);
  const Surface across = triangles_of({{Vec3d{-7, -0.5, 0}, Vec3d{5, -0.25, 0}, Vec3d{6, 0.75, 0}}});
  expect_truth(bracket(across, triangles_of(sheets)), 0.125);
}

// Each edge of the triangle lies along a triangle of its own, and the middle beside none. Of a long one the middle of
// its corners is not what is farthest: that lies towards the short edge.
TEST(SurfaceBracket, FindsTheMiddleOfAFrame) {
  const std::array<Vec3d, 3> corner{Vec3d{-0.5, 0, 0}, Vec3d{0.5, 0, 0}, Vec3d{0, 6, 0}};
  const double side = std::hypot(6.0, 0.5), inradius = 6.0 / (1.0 + 2.0 * side);
  for (std::size_t first = 0; first < 3; ++first) {
    const Vec3d &a = corner[first], &b = corner[(first + 1) % 3], &c = corner[(first + 2) % 3];
    const Vec3d out{0, 2, 0};
    const Surface frame = triangles_of({{a, b, a + b - out}, {b, c, b + c - out}, {c, a, c + a - out}});
    expect_truth(bracket(triangles_of({{a, b, c}}), frame), inradius);
  }
}

TEST(SurfaceBracket, FindsTheLineBetweenTwoSlopes) {
  // A plane at height 1 over a valley: farthest over its bottom, where two triangles are as near.
  std::vector<std::array<Vec3d, 3>> valley, plane;
  add_slope(valley, -4, 1, 0.3, 0);
  add_slope(valley, 0.3, 0, 5, 1);
  add_slope(plane, -4, 1, 5, 1);
  const double left = 4.3 / std::hypot(4.3, 1.0), right = 4.7 / std::hypot(4.7, 1.0);
  const double truth = std::min(left, right);  // at the place where both are as far: a little beside the bottom
  const Bracket found = bracket(triangles_of(plane), triangles_of(valley));
  EXPECT_GE(found.upper, truth);
  EXPECT_LE(found.lower, std::max(left, right));
  EXPECT_LE(found.upper, found.lower * 1.003);
}

TEST(SurfaceBracket, OfAPeakIsItsHeightAndOfWhatIsBelowItLess) {
  // A pyramid of height 0.25 inside a triangle.
  const Vec3d a{-8, -8, 0}, b{8, -8, 0}, c{0, 9, 0}, top{0.3, 0.2, 0.25}, p{0, 0, 0}, q{1, 0, 0}, r{0, 1, 0};
  const Surface plane = triangles_of({{a, b, c}}), peak = triangles_of({{p, q, top}, {q, r, top}, {r, p, top}});
  expect_truth(bracket(peak, plane), 0.25);
}

TEST(SurfaceBracket, OfABoxInASphereAndTheOtherWay) {
  const Surface sphere = make_sphere(40), box = make_box(1.0 / std::sqrt(3.0));
  const Bracket outward = bracket(sphere, box);
  EXPECT_NEAR(outward.lower, 1.0 - 1.0 / std::sqrt(3.0), 0.01);  // over the middle of a face
  EXPECT_LE(outward.upper, outward.lower * 1.003);
  const Bracket inward = bracket(box, sphere);
  EXPECT_NEAR(inward.lower, 1.0 - 1.0 / std::sqrt(3.0), 0.01);
  EXPECT_LE(inward.upper, inward.lower * 1.003);
}

TEST(SurfaceBracket, StopsAtWhatIsEnoughAndSaysNothingOfWhatIsBelow) {
  const Surface sphere = make_sphere(40), box = make_box(1.0 / std::sqrt(3.0));
  const Bracket found = bracket(sphere, box, {.enough = 0.5, .budget = 1000000});
  EXPECT_EQ(found.upper, 0.5);
  EXPECT_LT(found.lower, 0.43);
  EXPECT_LT(found.splits, 100U);
}

/// What is met near a vertex is some triangle that is near enough: no distance of the surfaces.
TEST(SurfaceBracket, SaysNoDistanceThatIsNotTheSurfaces) {
  RandomSource random(4711);
  for (const double enough : {1e-6, 0.02, 0.2, 2.0}) {
    const Surface a = make_soup(random, 40, Vec3d(0.0)), b = make_soup(random, 400, Vec3d(0.0));
    const double truth = bracket(a, b).upper;
    const Bracket found = bracket(a, b, {.enough = enough, .budget = 1000000});
    EXPECT_LE(found.lower, truth * (1.0 + 1e-9)) << enough;
    EXPECT_GE(found.upper, truth * (1.0 - 1e-9)) << enough;
    EXPECT_LE(bracket(b, b, {.enough = enough, .budget = 1000000}).lower, 1e-9) << enough;
  }
}

// A corner at a distance whose square is not that of its root: near enough as a distance, and not as a square.
TEST(SurfaceBracket, GoesOnWhereACornerIsExactlyAsFarAsIsEnough) {
  ASSERT_LT(std::sqrt(3.0) * std::sqrt(3.0), 3.0);
  const Vec3d p{1, 1, 1}, q{1, 1, 101}, r{1, 101, 1};
  const Surface piece = triangles_of({{p, q, r}});
  const Surface target =
      triangles_of({{Vec3d{0, 0, 0}, Vec3d{-9, 0, 0}, Vec3d{0, -9, 0}}, {q, r, Vec3d{101, 101, 101}}});
  const Bracket found = bracket(piece, target, {.enough = std::sqrt(3.0), .budget = 1000});
  EXPECT_EQ(found.undecided, 0U);
  EXPECT_GE(found.lower, sampled(piece, target, 100) * 0.998);
  EXPECT_LE(found.upper, found.lower * 1.003);

  RandomSource random(13);
  for (int i = 0; i < 300; ++i) {
    const Surface a = make_soup(random, 3, Vec3d(0.0)), b = make_soup(random, 7, Vec3d(0.0));
    const TriangleTree tree(b);
    for (const Vec3d& corner : a.positions) {
      const double enough = std::sqrt(tree.nearest(corner).distance2);
      EXPECT_EQ(bracket(a, b, {.enough = enough, .budget = 100000}).undecided, 0U) << i;
    }
  }
}

TEST(SurfaceBracket, SaysWhatTheBudgetLeftUndecided) {
  const Surface sphere = make_sphere(40), box = make_box(1.0 / std::sqrt(3.0));
  const Bracket none = bracket(box, sphere, {.enough = 1e-9, .budget = 0});
  EXPECT_GT(none.undecided, 0U);
  EXPECT_GT(none.upper, none.lower * 1.01);
  const Bracket all = bracket(box, sphere);
  EXPECT_LE(none.lower, all.upper);
  EXPECT_GE(none.upper, all.lower);
  // Each corner is over a point of its own: no point of the piece is farther than a corner is from another's.
  const Vec3d p{0, 0, 1}, q{0.3, 0, 1}, r{0.15, std::sqrt(0.0675), 1}, down{0, 0, 1};
  const Surface points =
      triangles_of({{p - down, p - down, p - down}, {q - down, q - down, q - down}, {r - down, r - down, r - down}});
  const Bracket over = bracket(triangles_of({{p, q, r}}), points, {.enough = 1e-9, .budget = 0});
  EXPECT_EQ(over.undecided, 1U);
  EXPECT_DOUBLE_EQ(over.lower, 1.0);
  EXPECT_NEAR(over.upper, std::hypot(1.0, 0.3), 1e-12);
}

TEST(SurfaceBracket, FindsThePeaksThatNoSampleMet) {
  for (const Peak& peak : {wide_peak(), narrow_peak()}) {
    const Bracket found = bracket(peak.source, peak.cut, {.enough = peak.stored, .budget = 1000});
    EXPECT_GE(found.lower, peak.truth * 0.998);
    EXPECT_LE(found.lower, peak.truth * 1.002);
    EXPECT_LE(found.upper, found.lower * 1.003);
    EXPECT_EQ(found.undecided, 0U);
  }
}

TEST(SurfaceBracket, HoldsDenseSamplesOfSoupsAtAnyOffset) {
  RandomSource random(7);
  for (int i = 0; i < 30; ++i) {
    const Vec3d offset = i % 3 == 0 ? Vec3d(0.0) : random.in_cube(i % 3 == 1 ? 1e3 : 1e7);
    const Surface a = make_soup(random, 12, offset), b = make_soup(random, 25, offset);
    const double dense = sampled(a, b, 40), rounding = 1e-15 * 2e7;
    const Bracket found = bracket(a, b, {.enough = 1e-6, .budget = 2000000});
    EXPECT_EQ(found.undecided, 0U) << i;
    EXPECT_LE(found.upper, found.lower * 1.0021 + 1e-6) << i;
    EXPECT_GE(found.upper + rounding, dense) << i;
    const Bracket enough = bracket(a, b, {.enough = 0.9 * dense, .budget = 2000000});
    EXPECT_GE(enough.lower * 1.0021, dense) << i << ": what is above what is enough is looked for";
    const Bracket above = bracket(a, b, {.enough = found.upper, .budget = 2000000});
    EXPECT_EQ(above.upper, found.upper) << i << ": nothing is";
  }
}

TEST(SurfaceBracket, DecidesWhatLiesAmongManyTrianglesThatCross) {
  RandomSource random(77);
  const auto make_large = [&](std::size_t count, double size) {
    std::vector<std::array<Vec3d, 3>> triangles(count);
    for (auto& t : triangles) t = {random.in_cube(size), random.in_cube(size), random.in_cube(size)};
    return triangles_of(triangles);
  };
  const Surface crossing = make_large(3000, 1.0), among = make_large(20, 0.5);
  const Bracket exact = bracket(among, crossing, {.enough = 0.005, .budget = 1000000});
  EXPECT_EQ(exact.undecided, 0U);
  EXPECT_LE(exact.upper, exact.lower * 1.0021);
  const Bracket within = bracket(among, crossing, {.enough = 0.01, .budget = 1000000});
  EXPECT_EQ(within.undecided, 0U);
  EXPECT_EQ(within.upper, 0.01);
  EXPECT_LE(within.lower, exact.upper);
  EXPECT_LT(within.splits, 34000U) << "more without a triangle that all of a piece is near to";
}

TEST(SurfaceBracket, DecidesLargeTrianglesOverManyVerticesOfAFlatSheet) {
  // As a sheet without error is: off by what a grid moves its vertices.
  RandomSource random(78);
  constexpr std::uint32_t kCells = 40;
  constexpr double kNoise = 1e-7;
  Surface fine;
  for (std::uint32_t y = 0; y <= kCells; ++y) {
    for (std::uint32_t x = 0; x <= kCells; ++x) {
      fine.positions.push_back(Vec3d(x, y, 0) / double{kCells} + random.in_cube(kNoise));
    }
  }
  for (std::uint32_t y = 0; y < kCells; ++y) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const std::uint32_t a = y * (kCells + 1) + x, b = a + kCells + 1;
      fine.triangles.push_back({a, a + 1, b + 1});
      fine.triangles.push_back({a, b + 1, b});
    }
  }
  // Diagonals of both ways: along the edges of the sheet, and across them.
  for (const bool is_along : {true, false}) {
    const Vec3d a{0.01, 0.013, 0}, b{0.98, 0.02, 0}, c{0.97, 0.985, 0}, d{0.015, 0.99, 0};
    const Surface coarse = is_along ? triangles_of({{a, b, c}, {a, c, d}}) : triangles_of({{a, b, d}, {b, c, d}});
    const Bracket found = bracket(coarse, fine, {.enough = 4.0 * kNoise, .budget = 120000});
    EXPECT_EQ(found.undecided, 0U);
    EXPECT_EQ(found.upper, 4.0 * kNoise);
    EXPECT_GT(found.lower, 0.0);
  }
}

TEST(SurfaceBracket, DecidesACopyAmongManyTrianglesOfALattice) {
  // Each triangle lies beside its copy; many others are near to each of its corners.
  RandomSource random(79);
  std::vector<std::array<Vec3d, 3>> triangles(4000);
  for (auto& t : triangles) {
    for (Vec3d& p : t) p = glm::floor(random.in_cube(4.0) + 0.5) * 0.25;
  }
  constexpr double kMove = 1e-4;
  std::vector<std::array<Vec3d, 3>> moved = triangles;
  for (auto& t : moved) {
    for (Vec3d& p : t) p = p * (1.0 - kMove) + Vec3d(kMove, 0, 0);
  }
  const Surface source = triangles_of(triangles), cut = triangles_of(moved);
  const Bracket found = bracket(cut, source, {.enough = 5.0 * kMove, .budget = 64000});
  EXPECT_EQ(found.undecided, 0U);
  EXPECT_EQ(found.upper, 5.0 * kMove);
}

TEST(SurfaceBracket, DividesANeedleInItsOwnPoints) {
  // The normal of such a needle is mostly rounding, and what is found by it lies beside the needle.
  RandomSource random(80);
  for (int i = 0; i < 5000; ++i) {
    const double width = random.log_between(1e-17, 1e-9), enough = random.log_between(1e-3, 1e-1);
    const Vec3d p = random.in_cube(1.0), q = p + glm::normalize(random.in_cube(1.0));
    const auto beside = [&](double along) { return p + (q - p) * along + random.in_cube(0.7 * enough); };
    const Vec3d r = p + (q - p) * random.between(0.3, 0.7) + random.in_cube(width);
    Surface fan;
    const double of_p = random.between(0.1, 0.4), of_q = random.between(0.1, 0.4);
    fan.positions.push_back(p * of_p + q * of_q + r * (1.0 - of_p - of_q));
    for (int k = 0; k < 4; ++k) fan.positions.push_back(beside(k / 3.0));
    for (std::uint32_t k = 1; k < 4; ++k) fan.triangles.push_back({0, k, k + 1});
    const Bracket found = bracket(triangles_of({{p, q, r}}), fan, {.enough = enough, .budget = 1000});
    EXPECT_EQ(found.undecided, 0U) << i;
    if (found.lower > 0.0) {
      EXPECT_LE(std::sqrt(distance2_to_triangle(found.worst, p, q, r)), 1e-14) << i;
    }
  }
}

TEST(SurfaceBracket, OfFoldedSheetsHoldsDenseSamples) {
  // Zigzags against each other, of another number of folds.
  for (const auto& [first, second] : {std::pair{7, 5}, std::pair{12, 30}}) {
    std::vector<std::array<Vec3d, 3>> a, b;
    for (int i = 0; i < first; ++i)
      add_slope(a, 4.0 * i / first, i % 2 * 0.5, 4.0 * (i + 1) / first, (i + 1) % 2 * 0.5);
    for (int i = 0; i < second; ++i)
      add_slope(b, 4.0 * i / second, i % 2 * 0.4, 4.0 * (i + 1) / second, (i + 1) % 2 * 0.4);
    const Surface sa = triangles_of(a), sb = triangles_of(b);
    const Bracket found = bracket(sa, sb);
    EXPECT_LE(found.upper, found.lower * 1.003);
    EXPECT_GE(found.upper, sampled(sa, sb, 60));
  }
}

TEST(SurfaceBracket, SaysWhichPartsATriangleLiesNearTo) {
  std::vector<std::array<Vec3d, 3>> sheets;
  add_slope(sheets, -4, 0, 0, 0);
  add_slope(sheets, 0, 0, 4, 0);
  add_slope(sheets, 4, 0, 8, 0.5);
  const Surface b = triangles_of(sheets);
  const TriangleTree tree(b);
  const std::vector<std::uint32_t> parts{7, 7, 9, 9, 11, 11};
  const Surface a = triangles_of({{Vec3d{-3, -0.5, 0.01}, Vec3d{-1, -0.5, 0.01}, Vec3d{-1, 0.5, 0.01}},
                                  {Vec3d{-3, -0.5, 0.01}, Vec3d{3, -0.5, 0.01}, Vec3d{3, 0.5, 0.01}},
                                  {Vec3d{1, -0.5, 0.01}, Vec3d{7.5, -0.5, 0.01}, Vec3d{3, 0.5, 0.01}}});
  const std::vector<std::uint32_t> all{0, 1, 2};
  const Bracket found = bracket_one_way(a, all, {b, tree, parts}, {.enough = 0.02, .budget = 1000});
  ASSERT_EQ(found.near.size(), 3U);
  EXPECT_EQ(found.near[0].count, 1U);
  EXPECT_EQ(found.near[0].parts[0], 7U);
  EXPECT_EQ(found.near[1].count, 2U);
  EXPECT_FALSE(found.near[2].is_proven()) << "its end is too far from the slope";
}

TEST(SurfaceBracket, IsTheSameForAnyNumberOfThreads) {
  RandomSource random(11);
  const Surface a = make_soup(random, 900, Vec3d(0.0)), b = make_soup(random, 700, Vec3d(0.0));
  Bracket found[2];
  for (const int threads : {1, 2}) {
    tbb::task_arena(threads).execute([&] { found[threads - 1] = bracket(a, b, {.enough = 0.01, .budget = 20000}); });
  }
  EXPECT_EQ(found[0].lower, found[1].lower);
  EXPECT_EQ(found[0].upper, found[1].upper);
  EXPECT_EQ(found[0].undecided, found[1].undecided);
  EXPECT_EQ(found[0].splits, found[1].splits);
}

}  // namespace
}  // namespace meshlode::judge
