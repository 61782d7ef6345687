// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping and the divide: what crosses the near plane or the guard band still covers each pixel exactly once.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "raster_support.h"

namespace meshlode::draw {
namespace {

using namespace test;

constexpr ImageSize kSize{64, 48};
constexpr double kNear = 0.5;

ScreenSoup clip(const std::vector<std::array<ClipVertex, 3>>& triangles, Culling culling = Culling::kNone) {
  ScreenSoup soup;
  std::uint32_t id = 0;
  for (const auto& v : triangles) add_triangle(v, culling, {0, id++}, kSize, soup);
  return soup;
}

TEST(RasterClip, DividesToTheNearestSubpixel) {
  test::Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double w = std::ldexp(random.range(1.0, 2.0), random.between(-60, 60));
    const double x = random.range(-100.0, 100.0), y = random.range(-100.0, 100.0);
    const auto v = snap_vertex({x * w, y * w, 0.25 * w, w}, kSize);
    ASSERT_TRUE(v);
    EXPECT_NEAR(v->x, (x + 32.0) * 256.0, 0.5001);
    EXPECT_NEAR(v->y, (y + 24.0) * 256.0, 0.5001);
    EXPECT_NEAR(v->depth, 0x1p30, 4.0);
  }
}

TEST(RasterClip, ScalingByAPowerOfTwoChangesNothing) {
  test::Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const ClipVertex v{random.range(-50, 50), random.range(-50, 50), kNear, random.range(0.6, 40.0)};
    const auto a = snap_vertex(v, kSize);
    const double s = std::ldexp(1.0, random.between(-200, 200));
    const auto b = snap_vertex({v.x * s, v.y * s, v.z * s, v.w * s}, kSize);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->x, b->x);
    EXPECT_EQ(a->y, b->y);
    EXPECT_EQ(a->depth, b->depth);
  }
}

TEST(RasterClip, DepthGrowsTowardsTheViewerAndIsLargestAtTheNearPlane) {
  std::uint32_t last = 0;
  for (double w = 1000.0; w >= kNear; w *= 0.97) {
    const auto v = snap_vertex({0.0, 0.0, kNear, w}, kSize);
    ASSERT_TRUE(v);
    EXPECT_GE(v->depth, last);
    last = v->depth;
  }
  EXPECT_EQ(snap_vertex({0.0, 0.0, kNear, kNear}, kSize)->depth, 0xFFFFFFFFu);
}

TEST(RasterClip, WhatIsBehindTheViewerIsNotDrawn) {
  const ScreenSoup soup = clip({{{{0, 0, kNear, -1}, {10, 0, kNear, -2}, {0, 10, kNear, -3}}},
                                {{{0, 0, kNear, 0.4}, {10, 0, kNear, 0.1}, {0, 10, kNear, 0.0}}}});
  EXPECT_TRUE(soup.triangles.empty());
  EXPECT_TRUE(soup.polygons.empty());
  EXPECT_EQ(soup.not_finite, 0u);
}

// A floor under the viewer that goes through the near plane and behind: below the horizon all pixels are its own.
TEST(RasterClip, AFloorThroughTheNearPlaneFillsThePictureBelowTheHorizon) {
  const double k = 60.0;  // pixels per unit at distance 1
  const auto point = [&](double x, double z) { return ClipVertex{k * x, k * 1.0, kNear, z}; };  // 1 below the eye
  const double far = 1e4;
  const ScreenSoup soup = clip({{{point(-far, -far), point(far, -far), point(far, far)}},
                                {{point(-far, -far), point(far, far), point(-far, far)}}});
  EXPECT_EQ(soup.polygons.size(), 2u);
  const std::vector<int> counts = test::count_coverage(soup, kSize);
  for (std::uint32_t y = 0; y < kSize.height; ++y) {
    for (std::uint32_t x = 0; x < kSize.width; ++x) {
      EXPECT_EQ(counts[y * kSize.width + x], y >= kSize.height / 2 ? 1 : 0) << x << "," << y;
    }
  }
  // Depth is that of the plane: at row r the floor is at distance k / (r - middle).
  const VisibilityBuffer buffer = test::draw(soup, kSize);
  for (std::uint32_t y = 26; y < kSize.height; ++y) {
    const double distance = k / (y + 0.5 - 24.0);
    // Snapping moves the horizon by up to half a subpixel.
    const double tolerance = 0.6 / kSubpixels / (y + 0.5 - 24.0);
    EXPECT_NEAR(buffer.depth[y * kSize.width + 20] / (0x1p32 * kNear / distance), 1.0, tolerance) << y;
  }
}

/// A random planar grid in space, seen from inside it: many triangles cross the near plane and the guard band. Each
/// pixel is covered exactly once where the unclipped plane covers it.
TEST(RasterClip, ClippedGridsCoverEveryPixelExactlyOnce) {
  test::Random random(77);
  std::size_t clipped = 0, full = 0, folded = 0;
  for (int round = 0; round < 600; ++round) {
    // Plane through a point in front of the viewer, spanned by two random directions; huge extent in a third of rounds.
    const double extent = round % 3 == 0 ? 1e7 : 30.0;
    const auto direction = [&] { return std::array{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
    const auto u = direction(), v = direction();
    const double middle[3] = {random.range(-0.5, 0.5), random.range(-0.5, 0.5), random.range(0.8, 3.0)};
    constexpr int kCells = 6;
    std::vector<ClipVertex> points;
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) {
        const double s = extent * (2.0 * (i + random.range(-0.3, 0.3)) / kCells - 1.0);
        const double t = extent * (2.0 * (j + random.range(-0.3, 0.3)) / kCells - 1.0);
        double p[3];
        for (std::size_t c = 0; c < 3; ++c) p[c] = middle[c] + s * u[c] + t * v[c];
        points.push_back({50.0 * p[0], 50.0 * p[1], kNear, p[2]});
      }
    }
    std::vector<std::array<ClipVertex, 3>> triangles;
    for (int j = 0; j < kCells; ++j) {
      for (int i = 0; i < kCells; ++i) {
        const auto at = [&](int x, int y) {
          const int index = (j + y) * (kCells + 1) + i + x;
          return points[static_cast<std::size_t>(index)];
        };
        triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
        triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
      }
    }
    // A plane seen nearly edge-on: snapping turns slivers over, and folds cover a pixel twice on any rasterizer.
    // What is turned over is tiny.
    const ScreenSoup left = clip(triangles, Culling::kClockwise), right = clip(triangles, Culling::kCounterClockwise);
    const auto entries = [](const ScreenSoup& s) { return s.triangles.size() + s.polygons.size(); };
    if (entries(left) != 0 && entries(right) != 0) {
      ++folded;
      const auto pixels = [](const ScreenSoup& s) {
        const std::vector<int> counts = test::count_coverage(s, kSize);
        return std::accumulate(counts.begin(), counts.end(), 0);
      };
      EXPECT_LE(std::min(pixels(left), pixels(right)), 4) << "round " << round;
      continue;
    }
    const ScreenSoup soup = clip(triangles);
    clipped += soup.polygons.size();
    const std::vector<int> counts = test::count_coverage(soup, kSize);
    // The plane's own coverage: the ray through a pixel meets it in front of the near plane, well inside the extent.
    const double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (std::uint32_t y = 0; y < kSize.height; ++y) {
      for (std::uint32_t x = 0; x < kSize.width; ++x) {
        const int count = counts[y * kSize.width + x];
        ASSERT_LE(count, 1) << "round " << round << " pixel " << x << "," << y;
        const double ray[3] = {(x + 0.5 - 32.0) / 50.0, (y + 0.5 - 24.0) / 50.0, 1.0};
        const double along = n[0] * ray[0] + n[1] * ray[1] + n[2] * ray[2];
        const double w = (n[0] * middle[0] + n[1] * middle[1] + n[2] * middle[2]) / along;
        const double area = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!(w > 1.05 * kNear && w < 20.0) || area < 0.2 || std::abs(along) < 0.15) continue;
        double rest = 0.0;  // distance from the plane's middle
        for (std::size_t c = 0; c < 3; ++c) rest += (ray[c] * w - middle[c]) * (ray[c] * w - middle[c]);
        const double inner = 0.6 * extent * area / 1.8;
        if (std::sqrt(rest) > 0.5 * inner) continue;
        ASSERT_EQ(count, 1) << "round " << round << " pixel " << x << "," << y;
        ++full;
      }
    }
  }
  EXPECT_LT(folded, 150u);
  EXPECT_GT(clipped, 1000u);
  EXPECT_GT(full, 20000u);
}

TEST(RasterClip, NeighboursShareTheirCutVertex) {
  const ClipVertex a{10, 5, kNear, 2.0}, b{-7, 30, kNear, -3.0}, c{60, 10, kNear, 1.0}, d{-50, 20, kNear, 4.0};
  const ScreenSoup soup = clip({{{a, b, c}}, {{b, a, d}}});
  ASSERT_EQ(soup.polygons.size(), 2u);
  int shared = 0;
  for (std::uint32_t i = 0; i < soup.polygons[0].count; ++i) {
    for (std::uint32_t j = 0; j < soup.polygons[1].count; ++j) {
      const ScreenVertex &p = soup.polygons[0].v[i], &q = soup.polygons[1].v[j];
      shared += p.x == q.x && p.y == q.y && p.depth == q.depth ? 1 : 0;
    }
  }
  EXPECT_EQ(shared, 2);
}

TEST(RasterClip, CullingIsTheSameBeforeAndAfterClipping) {
  // A wall to the right that runs past the viewer: it faces left (inwards).
  const ClipVertex a{60, -60, kNear, 10}, b{60, 60, kNear, 10}, c{60, 60, kNear, -1};
  const std::size_t front = clip({{{a, b, c}}}, Culling::kClockwise).polygons.size();
  const std::size_t back = clip({{{a, c, b}}}, Culling::kClockwise).polygons.size();
  const std::size_t mirrored = clip({{{a, c, b}}}, Culling::kCounterClockwise).polygons.size();
  EXPECT_EQ(front + back, 1u);
  EXPECT_EQ(mirrored, front);
  EXPECT_EQ(clip({{{a, b, c}}}, Culling::kNone).polygons.size(), 1u);
}

TEST(RasterClip, HugeAndInfiniteCoordinatesAreCountedOrClipped) {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  const ClipVertex a{-20, -20, kNear, 1}, b{20, -20, kNear, 1};
  EXPECT_EQ(clip({{{a, b, {0, inf, kNear, 1}}}}).not_finite, 1u);
  EXPECT_EQ(clip({{{a, b, {nan, 0, kNear, 1}}}}).not_finite, 1u);
  EXPECT_EQ(clip({{{a, b, {0, 0, kNear, nan}}}}).not_finite, 1u);
  EXPECT_EQ(clip({{{a, b, {0, 1e200, kNear, 1}}}}).not_finite, 1u);
  for (const double far : {1e7, 1e30, 1e140}) {
    const ScreenSoup soup = clip({{{a, b, {0, far, kNear, 1}}}});
    ASSERT_EQ(soup.polygons.size(), 1u) << far;
    EXPECT_GT(test::count_drawn(test::draw(soup, kSize)), 40u * 40u) << far;
    for (std::uint32_t i = 0; i < soup.polygons[0].count; ++i) {
      EXPECT_LE(std::abs(soup.polygons[0].v[i].y), (1 << 28) + (1 << 22));
    }
  }
}

TEST(RasterClip, RandomGarbageNeverBreaksTheInvariants) {
  test::Random random(404);
  for (int i = 0; i < 20000; ++i) {
    std::array<ClipVertex, 3> v;
    for (ClipVertex& c : v) {
      const auto number = [&] { return std::ldexp(random.range(-1, 1), random.between(-300, 300)); };
      c = {number(), number(), kNear, random.next() % 4 == 0 ? random.range(-2, 2) : number()};
    }
    const ScreenSoup soup = clip({v});
    ASSERT_LE(soup.triangles.size() + soup.polygons.size() + soup.not_finite, 1u);
    for (const ScreenPolygon& p : soup.polygons) ASSERT_LE(p.count, ScreenPolygon::kMaxVertices);
    if (i % 50 == 0) (void)test::draw(soup, kSize);
  }
}

}  // namespace
}  // namespace meshlode::draw
