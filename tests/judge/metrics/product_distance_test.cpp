// SPDX-License-Identifier: GPL-3.0-or-later
// The distance in the product of positions, UVs and normals, against closed forms and brute force.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "judge/metrics/product_distance.h"
#include "judge/metrics/product_tree.h"
#include "lab/samples/samples.h"
#include "support/random.h"

namespace meshlode::judge {
namespace {

using test::RandomSource;

constexpr DeviationOptions kQuick{.samples = 20000, .seed = 1};
constexpr double kPi = 3.14159265358979323846;

ProductScales scales_of(double uv, double normal) {
  ProductScales scales;
  scales.uv[0] = Vec2d(uv);
  scales.normal = normal;
  return scales;
}

double largest(const ShadedSurface& a, const ShadedSurface& b, const ProductScales& scales) {
  return ProductDistanceFrom(a, scales, kQuick).find_largest(b).max;
}

/// The unit square in z = 0 of n x n cells whose vertices are shared within a chart. Cells left of `seam` are one
/// chart, those right of it another: their UVs are those of the square, plus `left` or `right` in u.
struct Square {
  std::uint32_t n = 10;
  double seam = 2.0, left = 0.0, right = 0.0;
  double tilt = 0.0;     ///< radians that normals lean from +z towards +x
  double density = 1.0;  ///< of UVs: 0 gives each chart one UV
};

ShadedSurface make_square(const Square& o) {
  ShadedSurface s;
  for (std::uint32_t y = 0; y < o.n; ++y) {
    for (std::uint32_t x = 0; x < o.n; ++x) {
      const auto base = static_cast<std::uint32_t>(s.surface.positions.size());
      const double add = (x + 0.5) / o.n < o.seam ? o.left : o.right;
      for (std::uint32_t k = 0; k < 4; ++k) {
        const double px = static_cast<double>(x + k % 2) / o.n, py = static_cast<double>(y + k / 2) / o.n;
        s.surface.positions.push_back({px, py, 0.0});
        s.normals.push_back(Vec3f(Vec3d(std::sin(o.tilt), 0.0, std::cos(o.tilt))));
        s.uvs[0].push_back(Vec2f(Vec2d(o.density * px + add, o.density * py)));
      }
      s.surface.triangles.push_back({base, base + 1, base + 3});
      s.surface.triangles.push_back({base, base + 3, base + 2});
    }
  }
  return s;
}

ShadedSurface shaded(const scene::Primitive& shape) {
  return shaded_surface_of_source(lab::as_mesh(shape));
}

/// A soup of any triangles, some of them needles, segments and points, with UVs and unit normals that turn by up to
/// `turn` radians from corner to corner.
ShadedSurface make_soup(RandomSource& random, std::uint32_t count, double turn) {
  ShadedSurface s;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec3d at = random.in_cube(1.0), uv = random.in_cube(1.0), normal = random.in_cube(1.0);
    const double edge = random.log_between(1e-2, 1.0);
    const int shape = random.between(0.0, 1.0) < 0.2 ? static_cast<int>(random.between(0.0, 3.0)) : 3;
    for (int k = 0; k < 3; ++k) {
      Vec3d offset = random.in_cube(edge);
      if (shape == 0) offset = Vec3d(edge * k, 0.0, 0.0);
      if (shape == 1) offset = Vec3d(edge * k, 1e-9 * k * k, 0.0);
      if (shape == 2) offset = Vec3d(0.0);
      s.surface.positions.push_back(at + offset);
      s.uvs[0].push_back(Vec2f(Vec2d(uv) + Vec2d(random.in_cube(edge))));
      s.normals.push_back(Vec3f(glm::normalize(normal) + std::tan(0.5 * turn) * random.in_cube(1.0)));
    }
    s.surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return s;
}

/// One triangle's nearest point by looking: a lattice of weights, and around its best one finer and finer ones. The
/// squared distance is convex over a flat triangle, so this cannot be led astray.
double nearest_by_looking(const product::Row<8>& x, const product::Corners<8>& corners) {
  const auto distance2 = [&](double u, double v) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 8; ++k) {
      const double d = (1.0 - u - v) * corners[0][k] + u * corners[1][k] + v * corners[2][k] - x[k];
      sum += d * d;
    }
    return sum;
  };
  struct At {
    double distance2, u, v;
  };
  At at{distance2(0.0, 0.0), 0.0, 0.0};
  constexpr int kCells = 24;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells - i; ++j) {
      const double u = static_cast<double>(i) / kCells, v = static_cast<double>(j) / kCells;
      if (const double d = distance2(u, v); d < at.distance2) at = {d, u, v};
    }
  }
  for (double step = 1.0 / kCells; step > 1e-8; step *= 0.7) {
    const At middle = at;
    for (int i = -2; i <= 2; ++i) {
      for (int j = -2; j <= 2; ++j) {
        const double u = std::clamp(middle.u + 0.5 * step * i, 0.0, 1.0);
        const double v = std::clamp(middle.v + 0.5 * step * j, 0.0, 1.0 - u);
        if (const double d = distance2(u, v); d < at.distance2) at = {d, u, v};
      }
    }
  }
  return at.distance2;
}

struct Embedded {
  std::vector<ProductPoint<8>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Position, one UV set and the normal, times lambda.
Embedded embed(const ShadedSurface& s, const ProductLayout& layout, double lambda) {
  Embedded out{{}, s.surface.triangles};
  for (std::size_t v = 0; v < s.surface.positions.size(); ++v) {
    ProductPoint<8> point;
    for (int k = 0; k < 3; ++k) point.x[static_cast<std::size_t>(k)] = s.surface.positions[v][k];
    point.x[3] = double{s.uvs[0][v].x};
    point.x[4] = double{s.uvs[0][v].y};
    if (layout.has_normal) product::put_normal<8>(point.x, 5, glm::normalize(Vec3d(s.normals[v])) * lambda);
    point.known = layout.all_known();
    out.vertices.push_back(point);
  }
  return out;
}

TEST(ProductDistance, NearestPointsAreThoseThatLookingFinds) {
  RandomSource random(31);
  for (const double turn : {0.0, 0.5, 1.5, 2.8}) {
    const ProductLayout layout{1, true};
    const Embedded to = embed(make_soup(random, 80, turn), layout, 0.4);
    const Embedded points = embed(make_soup(random, 20, turn), layout, 0.4);
    const ProductTree<8> tree(to.vertices, to.triangles, layout);
    for (const ProductPoint<8>& point : points.vertices) {
      double looked = std::numeric_limits<double>::infinity();
      for (const auto& t : to.triangles) {
        looked = std::min(looked,
                          nearest_by_looking(point.x, {to.vertices[t[0]].x, to.vertices[t[1]].x, to.vertices[t[2]].x}));
      }
      const double found = std::sqrt(tree.nearest(point).distance2);
      EXPECT_NEAR(found, std::sqrt(looked), 1e-6 * found) << "turn " << turn;
      for (const std::uint32_t hint : {kNoId, 7U}) {
        EXPECT_EQ(tree.any_within(0.998 * found * found, point, hint).triangle, kNoId);
        const auto within = tree.any_within(1.5 * found * found + 1e-12, point, hint);
        EXPECT_NE(within.triangle, kNoId);
        EXPECT_LT(within.distance2, 1.5 * found * found + 1e-12);
      }
    }
  }
}

// Some points and corners know no normal, or no UV: what both know counts.
TEST(ProductDistance, FramesThatAreMadeWhenLookedAtGiveTheSameDistances) {
  RandomSource random(32);
  const ProductLayout layout{1, true};
  const auto forget_some = [&](Embedded& embedded) {
    for (ProductPoint<8>& point : embedded.vertices) {
      if (random.below(6) == 0) {
        point.known &= ~2U;
        product::put_normal<8>(point.x, layout.normal_at(), Vec3d(0.0));
      }
      if (random.below(6) == 0) {
        point.known &= ~1U;
        point.x[3] = point.x[4] = 0.0;
      }
    }
  };
  Embedded to = embed(make_soup(random, 300, 1.0), layout, 0.4),
           points = embed(make_soup(random, 60, 1.0), layout, 0.4);
  forget_some(to);
  forget_some(points);
  const ProductTree<8> held(to.vertices, to.triangles, layout), made(to.vertices, to.triangles, layout, 0);
  for (const ProductPoint<8>& point : points.vertices) {
    const auto nearest = held.nearest(point), same = made.nearest(point);
    EXPECT_EQ(nearest.triangle, same.triangle);
    EXPECT_EQ(nearest.distance2, same.distance2) << "the same bits";
    EXPECT_LT(nearest.distance2, std::numeric_limits<double>::infinity());
    EXPECT_EQ(held.any_within(0.5, point, 11).distance2, made.any_within(0.5, point, 11).distance2);
  }
}

TEST(ProductDistance, FlatTrianglesAreMetInTheirInsideOnEdgesAndAtCorners) {
  // (4, 0, 0 | 0 …), (0, 4, 0 | 0 …), (0, 0, 0 | 4 …): one corner lies in another coordinate.
  product::Corners<8> corners{};
  corners[0][0] = corners[1][1] = corners[2][3] = 4.0;
  product::Row<8> x{};
  EXPECT_NEAR(product::nearest_on_flat<8>(x, corners).distance2, 16.0 / 3.0, 1e-12);  // the middle, 4/√3 from 0
  x[0] = 9.0;
  EXPECT_NEAR(product::nearest_on_flat<8>(x, corners).distance2, 25.0, 1e-12);
  x = {4.0, 4.0};
  EXPECT_NEAR(product::nearest_on_flat<8>(x, corners).distance2, 8.0, 1e-12);
  x[2] = 3.0;
  const product::FlatNearest edge = product::nearest_on_flat<8>(x, corners);
  EXPECT_NEAR(edge.distance2, 17.0, 1e-12);
  EXPECT_NEAR(edge.weight[0] + edge.weight[1], 1.0, 1e-12);
}

TEST(ProductDistance, ANeedlesOwnPointsAreOnItButForTheLastBitsOfItsLength) {
  RandomSource random(41);
  const auto row = [&] {
    product::Row<8> out{};
    for (std::size_t k = 0; k < 8; ++k) out[k] = random.signed_unit();
    return out;
  };
  for (const double height : {1e-1, 1e-3, 1e-5, 1e-8, 1e-11, 1e-13}) {
    for (int round = 0; round < 200; ++round) {
      const product::Row<8> at = row(), along = row(), aside = row();
      product::Corners<8> corners{at, at, at};
      const double foot = random.unit();
      for (std::size_t k = 0; k < 8; ++k) {
        corners[1][k] += along[k];
        corners[2][k] += foot * along[k] + height * aside[k];
      }
      const double b = 0.5 * random.unit(), c = 0.5 * random.unit();
      product::Row<8> inside{};
      for (std::size_t k = 0; k < 8; ++k) {
        inside[k] = corners[0][k] + b * (corners[1][k] - corners[0][k]) + c * (corners[2][k] - corners[0][k]);
      }
      for (const product::Row<8>& point : {corners[0], corners[1], corners[2], inside}) {
        EXPECT_LE(std::sqrt(product::nearest_on_flat<8>(point, corners).distance2), 2e-15) << "height " << height;
      }
    }
  }
}

TEST(ProductDistance, IsThatOfThePositionsWhereNothingElseCounts) {
  RandomSource random(5);
  for (int round = 0; round < 4; ++round) {
    const ShadedSurface a = make_soup(random, 200, 1.0), b = make_soup(random, 150, 1.0);
    const DeviationReport positions = DeviationFrom(a.surface, kQuick).measure(b.surface);
    const bool is_of_a = positions.a_to_b.max >= positions.b_to_a.max;
    const LargestDeviation product = ProductDistanceFrom(a, {}, kQuick).find_largest(b);
    EXPECT_NEAR(product.max, positions.max(), 1e-6 * positions.max());
    EXPECT_LE(glm::length(product.worst - (is_of_a ? positions.a_to_b : positions.b_to_a).worst), 1e-6);
    EXPECT_EQ(product.points, positions.a_to_b.points + positions.b_to_a.points);
    EXPECT_EQ(product.is_of_a, is_of_a);
  }
}

TEST(ProductDistance, NeverFallsWhereMoreCounts) {
  RandomSource random(6);
  const ShadedSurface a = make_soup(random, 300, 0.7), b = make_soup(random, 300, 0.7);
  const double position = largest(a, b, {}), texels = largest(a, b, scales_of(0.3, 0.0)),
               appearance = largest(a, b, scales_of(0.3, 0.2));
  EXPECT_LT(position, texels);
  EXPECT_LT(texels, appearance);
}

TEST(ProductDistance, IsZeroBetweenSurfacesThatAreOneHoweverTheyAreCut) {
  EXPECT_LE(largest(make_square({}), make_square({.n = 7}), scales_of(1.0, 0.5)), 1e-6);
  const ShadedSurface sphere = shaded(lab::with_smooth_normals(lab::make_sphere(6)));
  EXPECT_LE(largest(sphere, sphere, scales_of(1.0, 0.5)), 1e-8);
}

TEST(ProductDistance, OfMovedUvsIsHowFarTheyMovedInObjectUnits) {
  // One UV a chart: there is nothing to slide along.
  EXPECT_NEAR(largest(make_square({.density = 0.0}), make_square({.left = 0.01, .density = 0.0}), scales_of(3.0, 0.0)),
              0.03, 1e-7);
  // A texture that lies over the square: its border shows the whole move.
  EXPECT_NEAR(largest(make_square({}), make_square({.left = 0.125}), scales_of(1.0, 0.0)), 0.125, 1e-7);
  // Texels need not be square.
  ProductScales scales;
  scales.uv[0] = {2.0, 7.0};
  EXPECT_NEAR(largest(make_square({.density = 0.0}), make_square({.left = 0.01, .density = 0.0}), scales), 0.02, 1e-7);
}

TEST(ProductDistance, InsideATextureThatMovedLessCountsThanTheMove) {
  // Away from the border the nearest point lies half way back: 0.02 / √2 of a texture as dense as the surface.
  ShadedSurface a = make_square({.n = 1}), b = make_square({.n = 1, .left = 0.02});
  const ProductScales scales = scales_of(1.0, 0.0);
  for (Vec3d& p : a.surface.positions) p = Vec3d(0.45 + 0.1 * p.x, 0.45 + 0.1 * p.y, 0.0);  // its middle alone
  for (Vec2f& uv : a.uvs[0]) uv = 0.45F + 0.1F * uv;
  const DistanceWeight inside = [](const Vec3d& p) {
    return std::abs(p.x - 0.5) < 0.03 && std::abs(p.y - 0.5) < 0.03 ? 1.0 : 1e-9;
  };
  EXPECT_NEAR(ProductDistanceFrom(a, scales, {.samples = 20000}).find_largest(b, inside).max, 0.02 / std::sqrt(2.0),
              0.02 * 1e-3);
}

TEST(ProductDistance, OfTurnedNormalsIsTheChordOfTheirAngle) {
  for (const double angle : {0.02, 0.4, 1.2}) {
    EXPECT_NEAR(largest(make_square({}), make_square({.tilt = angle}), scales_of(1.0, 0.25)),
                0.25 * 2.0 * std::sin(0.5 * angle), 1e-6);
  }
  EXPECT_LE(largest(make_square({}), make_square({.tilt = 0.4}), scales_of(1.0, 0.0)), 1e-8) << "they do not count";
}

TEST(ProductDistance, NormalsAreLinearBetweenCorners) {
  // A strip whose corner normals lean 50 degrees either way, against one whose normals stand upright: in the middle it
  // is cos 50° long.
  const double half = 50.0 * kPi / 180.0;
  ShadedSurface leaning, upright;
  for (std::uint32_t i = 0; i < 4; ++i) {
    leaning.surface.positions.push_back({i % 2, i / 2, 0.0});
    leaning.normals.push_back(Vec3f(Vec3d((i % 2 == 0 ? -1.0 : 1.0) * std::sin(half), 0.0, std::cos(half))));
  }
  leaning.surface.triangles = {{0, 1, 3}, {0, 3, 2}};
  upright = leaning;
  upright.surface.positions = {{0.5, 0.0, 0.0}, {0.5 + 1e-9, 0.0, 0.0}, {0.5, 1.0, 0.0}, {0.5 + 1e-9, 1.0, 0.0}};
  upright.normals.assign(4, Vec3f(0.0F, 0.0F, 1.0F));
  const auto only_upright = [](const Vec3d& p) { return p.x == 0.5 && (p.y == 0.0 || p.y == 1.0) ? 1.0 : 1e-9; };
  // The nearest point lies in the middle: to go along the strip takes length and does not make the normal longer.
  EXPECT_NEAR(ProductDistanceFrom(upright, scales_of(0.0, 2.0), kQuick).find_largest(leaning, only_upright).max,
              2.0 * (1.0 - std::cos(half)), 1e-6);
}

TEST(ProductDistance, OfASeamThatMovedSidewaysIsHowFarItMoved) {
  const Square before{.n = 20, .seam = 0.5, .left = 0.0, .right = 10.0, .density = 0.0};
  Square after = before;
  after.seam = 0.6;
  EXPECT_NEAR(largest(make_square(before), make_square(after), scales_of(1.0, 0.0)), 0.1, 1e-3);
  // With a texture over each chart its texels moved along with it.
  Square textured = before, moved = after;
  textured.density = moved.density = 1.0;
  EXPECT_NEAR(largest(make_square(textured), make_square(moved), scales_of(1.0, 0.0)), 0.1 * std::sqrt(2.0), 2e-3);
}

TEST(ProductDistance, DegenerateTrianglesAreTheirEdgesAndCorners) {
  ShadedSurface a = make_square({}), b = make_square({});
  const auto base = static_cast<std::uint32_t>(b.surface.positions.size());
  for (int k = 0; k < 3; ++k) {  // a segment that stands up from the middle
    b.surface.positions.push_back({0.5, 0.5, 0.15 * k});
    b.uvs[0].push_back(Vec2f(0.5F));
    b.normals.push_back(Vec3f(0.0F, 0.0F, 1.0F));
  }
  b.surface.triangles.push_back({base, base + 1, base + 2});
  b.surface.triangles.push_back({base + 1, base + 1, base + 1});
  const LargestDeviation found = ProductDistanceFrom(a, scales_of(1.0, 0.5), kQuick).find_largest(b);
  EXPECT_NEAR(found.max, 0.3, 1e-7);
  EXPECT_FALSE(found.is_of_a);
  EXPECT_NEAR(found.worst.z, 0.3, 1e-12);
}

TEST(ProductDistance, WhatIsNotKnownIsNotCompared) {
  ShadedSurface a = make_square({.density = 0.0}), b = make_square({.left = 0.2, .tilt = 0.3, .density = 0.0});
  const ProductScales scales = scales_of(1.0, 0.5);
  ASSERT_GT(largest(a, b, scales), 0.2);
  ShadedSurface bare = b;
  bare.uvs[0].clear();
  EXPECT_NEAR(largest(a, bare, scales), 0.5 * 2.0 * std::sin(0.15), 1e-6);
  EXPECT_NEAR(largest(bare, a, scales), 0.5 * 2.0 * std::sin(0.15), 1e-6);
  bare.normals.assign(bare.normals.size(), Vec3f(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_LE(largest(a, bare, scales), 1e-8);
  // A few vertices alone: the triangles around them are not compared, all others are.
  a.uvs[0][0] = Vec2f(std::numeric_limits<float>::infinity());
  EXPECT_NEAR(largest(a, b, scales_of(1.0, 0.0)), 0.2, 1e-6);
}

TEST(ProductDistance, AWeightTellsHowMuchADistanceCounts) {
  const ShadedSurface a = make_square({.density = 0.0}), b = make_square({.left = 0.1, .density = 0.0});
  const ProductDistanceFrom from(a, scales_of(1.0, 0.0), kQuick);
  const Vec3d eye(2.0, 0.5, 0.0);
  const auto found = from.find_largest(b, [&](const Vec3d& p) { return 100.0 / glm::length(p - eye); });
  EXPECT_NEAR(found.max, 0.1 * 100.0, 0.1 * 100.0 * 1e-3) << "seen from 1 away, where the square ends";
  EXPECT_NEAR(found.worst.x, 1.0, 1e-3);
}

TEST(ProductDistance, AnEmptySurfaceIsInfinitelyFar) {
  const ShadedSurface empty, square = make_square({});
  EXPECT_EQ(largest(empty, empty, {}), 0.0);
  EXPECT_EQ(largest(empty, square, {}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(largest(square, empty, {}), std::numeric_limits<double>::infinity());
}

/// A triangle without area far off, behind those of a square.
ShadedSurface with_strand(ShadedSurface s) {
  const auto base = static_cast<std::uint32_t>(s.surface.positions.size());
  for (int k = 0; k < 3; ++k) {
    s.surface.positions.push_back(Vec3d(5.0 + k, 0.0, 0.0));
    s.normals.push_back(s.normals[0]);
    s.uvs[0].push_back(s.uvs[0][0]);
  }
  s.surface.triangles.push_back({base, base + 1, base + 2});
  return s;
}

TEST(ProductDistance, WhatDrawsNothingIsThereForOthersAlone) {
  const ShadedSurface square = make_square({});
  ShadedSurface strand = with_strand(square);
  EXPECT_GT(largest(square, strand, scales_of(1.0, 1.0)), 4.0) << "were it drawn";
  EXPECT_GT(largest(strand, square, scales_of(1.0, 1.0)), 4.0);
  strand.undrawn = 1;
  EXPECT_LE(largest(square, strand, scales_of(1.0, 1.0)), 1e-12);
  EXPECT_LE(largest(strand, square, scales_of(1.0, 1.0)), 1e-12);
  EXPECT_LE(largest(with_strand(square), strand, scales_of(1.0, 1.0)), 1e-9) << "what is drawn there lies on it";
}

TEST(ProductDistance, OfSinglePointsIsThatOfTheSurfacesAtMost) {
  RandomSource random(79);
  const ShadedSurface a = make_soup(random, 60, 1.0), b = make_soup(random, 40, 1.0);
  const ProductScales scales = scales_of(0.4, 0.3);
  const ProductSurface from(a, scales), to(b, scales);
  double farthest = 0.0;
  for (std::uint32_t t = 0; t < 60; ++t) {
    for (const auto& [u, v] : {std::array{0.0, 0.0}, std::array{1.0, 0.0}, std::array{0.0, 1.0}})
      farthest = std::max(farthest, from.distance_to(to, t, u, v));
    EXPECT_LE(from.distance_to(from, t, 0.2, 0.3), 1e-7) << t;
  }
  const LargestDeviation whole = ProductDistanceFrom(a, scales, {.samples = 0}).find_largest(b);
  ASSERT_TRUE(whole.is_of_a) << "as it falls with this seed";
  EXPECT_NEAR(farthest, whole.max, 1e-12);
  // A texture that swam by a tenth, twice as wide: each inner point is off by that.
  const ShadedSurface here = make_square({}), there = make_square({.left = 0.1});
  const ProductScales wide = scales_of(2.0, 0.0);
  EXPECT_GT(ProductSurface(here, wide).distance_to(ProductSurface(there, wide), 0, 0.3, 0.3), 0.01);
  EXPECT_EQ(ProductSurface(here, wide).distance_to(ProductSurface(ShadedSurface(), wide), 0, 0.3, 0.3),
            std::numeric_limits<double>::infinity());
}

TEST(ProductDistance, DoesNotDependOnTheNumberOfThreads) {
  RandomSource random(77);
  const ShadedSurface a = make_soup(random, 400, 1.0), b = make_soup(random, 300, 1.0);
  std::array<LargestDeviation, 4> found;
  for (const int threads : {1, 2, 3, 4}) {
    tbb::task_arena(threads).execute([&] {
      found[static_cast<std::size_t>(threads - 1)] =
          ProductDistanceFrom(a, scales_of(0.4, 0.3), kQuick).find_largest(b);
    });
  }
  for (const LargestDeviation& other : found) {
    EXPECT_EQ(other.max, found[0].max);
    EXPECT_EQ(other.worst, found[0].worst);
    EXPECT_EQ(other.is_of_a, found[0].is_of_a);
  }
}

TEST(ProductDistance, ManyUvSetsCountTogether) {
  ShadedSurface a = make_square({.density = 0.0}), b = a;
  ProductScales scales;
  for (std::size_t n = 0; n < scene::kMaxUvSets; ++n) {
    a.uvs[n].assign(a.surface.positions.size(), Vec2f(0.25F));
    b.uvs[n].assign(b.surface.positions.size(), Vec2f(0.25F + 0.125F * static_cast<float>(n == 0 ? 3 : n)));
    scales.uv[n] = Vec2d(1.0);
  }
  scales.normal = 1.0;
  // (3² + 1² + 2² + 3²) eighths, in both directions of each set
  EXPECT_NEAR(largest(a, b, scales), 0.125 * std::sqrt(2.0 * 23.0), 1e-6);
}

}  // namespace
}  // namespace meshlode::judge
