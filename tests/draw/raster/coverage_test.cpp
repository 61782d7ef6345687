// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage: every pixel centre belongs to exactly one of the triangles around it, and depth decides with a stable key.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "raster_support.h"

namespace meshlode::draw {
namespace {

using namespace test;

constexpr ImageSize kSize{64, 64};

ScreenVertex pixel_vertex(double x, double y, std::uint32_t depth = 1000) {
  return {static_cast<std::int32_t>(std::lround(x * kSubpixels)),
          static_cast<std::int32_t>(std::lround(y * kSubpixels)), depth};
}

ScreenSoup one_triangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                        Culling culling = Culling::kNone, ImageSize size = kSize) {
  ScreenSoup soup;
  add_snapped(a, b, c, culling, {0, 0}, size, soup);
  return soup;
}

std::vector<std::pair<int, int>> drawn_pixels(const VisibilityBuffer& buffer) {
  std::vector<std::pair<int, int>> pixels;
  for (std::size_t i = 0; i < buffer.item.size(); ++i) {
    if (buffer.item[i] != VisibilityBuffer::kNothing) {
      pixels.emplace_back(static_cast<int>(i % buffer.width), static_cast<int>(i / buffer.width));
    }
  }
  return pixels;
}

// A square of 2 x 2 pixels whose sides run through pixel centres: the centres on its top and left sides are its own.
TEST(Raster, TopAndLeftEdgesOwnTheirPixels) {
  ScreenSoup soup;
  const ScreenVertex a = pixel_vertex(10.5, 10.5), b = pixel_vertex(12.5, 10.5), c = pixel_vertex(12.5, 12.5),
                     d = pixel_vertex(10.5, 12.5);
  add_snapped(a, b, c, Culling::kNone, {0, 0}, kSize, soup);
  add_snapped(a, c, d, Culling::kNone, {0, 1}, kSize, soup);
  const std::vector<std::pair<int, int>> expected = {{10, 10}, {11, 10}, {10, 11}, {11, 11}};
  EXPECT_EQ(drawn_pixels(test::draw(soup, kSize)), expected);
}

// The diagonal runs from the upper right to the lower left: it is a left edge of the lower triangle only.
TEST(Raster, DiagonalPixelsBelongToTheTriangleOnTheirRight) {
  const VisibilityBuffer upper =
      test::draw(one_triangle(pixel_vertex(0.5, 0.5), pixel_vertex(4.5, 0.5), pixel_vertex(0.5, 4.5)), kSize);
  const VisibilityBuffer lower =
      test::draw(one_triangle(pixel_vertex(4.5, 0.5), pixel_vertex(4.5, 4.5), pixel_vertex(0.5, 4.5)), kSize);
  EXPECT_EQ(test::count_drawn(upper), 4u + 3u + 2u + 1u);  // nothing of the diagonal
  EXPECT_EQ(test::count_drawn(lower), 1u + 2u + 3u);  // the diagonal, without its ends on the right and bottom sides
  EXPECT_EQ(lower.item[1 * 64 + 3], 0u);
  EXPECT_EQ(upper.item[1 * 64 + 3], VisibilityBuffer::kNothing);
}

TEST(Raster, AVertexOnACentreIsDrawnOnlyByTheTriangleBelowAndRight) {
  // Four triangles around the centre of pixel (8, 8).
  const ScreenVertex m = pixel_vertex(8.5, 8.5), n = pixel_vertex(8.5, 4.5), e = pixel_vertex(12.5, 8.5),
                     s = pixel_vertex(8.5, 12.5), w = pixel_vertex(4.5, 8.5);
  ScreenSoup soup;
  add_snapped(m, n, e, Culling::kNone, {0, 0}, kSize, soup);
  add_snapped(m, e, s, Culling::kNone, {1, 0}, kSize, soup);
  add_snapped(m, s, w, Culling::kNone, {2, 0}, kSize, soup);
  add_snapped(m, w, n, Culling::kNone, {3, 0}, kSize, soup);
  ASSERT_EQ(soup.triangles.size(), 4u);
  EXPECT_EQ(test::draw(soup, kSize).item[8 * 64 + 8], 1u);
  const std::vector<int> counts = test::count_coverage(soup, kSize);
  EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 1);
}

TEST(Raster, AreaInPixelsIsTheClosedForm) {
  // Sides on pixel borders: a right triangle of 32 x 32 pixels has 32 * 31 / 2 whole pixels and 32 halves on its
  // diagonal, whose centres go to one side.
  const std::size_t drawn =
      test::count_drawn(test::draw(one_triangle(pixel_vertex(4, 4), pixel_vertex(36, 4), pixel_vertex(4, 36)), kSize));
  const std::size_t other = test::count_drawn(
      test::draw(one_triangle(pixel_vertex(36, 4), pixel_vertex(36, 36), pixel_vertex(4, 36)), kSize));
  EXPECT_EQ(drawn + other, 32u * 32u);
  EXPECT_EQ(std::min(drawn, other), 32u * 31u / 2u);
  // A big triangle at an odd angle: pixels = area up to half the border.
  test::Random random(5);
  for (int i = 0; i < 200; ++i) {
    constexpr ImageSize kLarge{600, 600};
    const ScreenVertex a{random.between(0, 153600), random.between(0, 153600), 1},
        b{random.between(0, 153600), random.between(0, 153600), 1},
        c{random.between(0, 153600), random.between(0, 153600), 1};
    const double area = 0.5 * std::abs(static_cast<double>(doubled_area(a, b, c))) / (kSubpixels * kSubpixels);
    const auto length = [](const ScreenVertex& p, const ScreenVertex& q) {
      return std::hypot(p.x - q.x, p.y - q.y) / kSubpixels;
    };
    const double border = length(a, b) + length(b, c) + length(c, a);
    const auto pixels =
        static_cast<double>(test::count_drawn(test::draw(one_triangle(a, b, c, Culling::kNone, kLarge), kLarge)));
    EXPECT_NEAR(pixels, area, 0.75 * border + 2.0);
  }
}

TEST(Raster, FansCoverEveryPixelExactlyOnce) {
  test::Random random(20240611);
  for (int round = 0; round < 400; ++round) {
    // Corners around a middle, by growing angle of less than half a turn: a star-shaped polygon.
    const int corners = random.between(3, 9);
    const bool on_centres = round % 3 == 0;  // vertices on pixel centres: the hard case
    const auto place = [&](double x, double y) {
      const double s = on_centres ? std::floor(x) + 0.5 : x, t = on_centres ? std::floor(y) + 0.5 : y;
      return pixel_vertex(s, t);
    };
    const ScreenVertex middle = place(random.range(24, 40), random.range(24, 40));
    std::vector<ScreenVertex> ring;
    for (int k = 0; k < corners; ++k) {
      const double turn = (k + random.range(0.1, 0.9)) / corners * 6.283185307179586, radius = random.range(10, 40);
      ring.push_back(place(middle.x / 256.0 + radius * std::cos(turn), middle.y / 256.0 + radius * std::sin(turn)));
    }
    ScreenSoup soup, reversed;
    bool is_star = true;
    for (int k = 0; k < corners; ++k) {
      const ScreenVertex& a = ring[static_cast<std::size_t>(k)];
      const ScreenVertex& b = ring[static_cast<std::size_t>((k + 1) % corners)];
      is_star = is_star && doubled_area(middle, a, b) > 0;
      add_snapped(middle, a, b, Culling::kNone, {0, static_cast<std::uint32_t>(k)}, kSize, soup);
      add_snapped(b, a, middle, Culling::kNone, {0, static_cast<std::uint32_t>(k)}, kSize, reversed);
    }
    if (!is_star) continue;
    const std::vector<int> counts = test::count_coverage(soup, kSize);
    EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 1) << "round " << round;
    EXPECT_EQ(counts, test::count_coverage(reversed, kSize)) << "round " << round;
    // No hole: a pixel centre strictly inside the polygon is drawn. Independent oracle: winding by crossings in
    // doubles.
    for (std::uint32_t y = 0; y < kSize.height; ++y) {
      for (std::uint32_t x = 0; x < kSize.width; ++x) {
        const double px = x + 0.5 + 1e-7, py = y + 0.5 + 1e-11;  // the top-left rule's infinitesimal, made finite
        int crossings = 0;
        for (std::size_t k = 0; k < ring.size(); ++k) {
          const ScreenVertex &a = ring[k], &b = ring[(k + 1) % ring.size()];
          const double ay = a.y / 256.0, by = b.y / 256.0;
          if ((ay > py) == (by > py)) continue;
          const double cross_x = a.x / 256.0 + (py - ay) / (by - ay) * (b.x - a.x) / 256.0;
          crossings += cross_x > px ? 1 : 0;
        }
        EXPECT_EQ(counts[y * kSize.width + x], crossings % 2) << "round " << round << " pixel " << x << "," << y;
      }
    }
  }
}

/// Its rows are asked for their first and last column, those of small triangles for each: by edge functions at every
/// centre here, of needles across the picture and up to the guard band, with level and upright sides among them.
TEST(Raster, LongTrianglesCoverWhatEachCentreSays) {
  constexpr ImageSize kWide{300, 40};
  test::Random random(20261129);
  int drawn = 0;
  for (int round = 0; round < 3000; ++round) {
    const bool on_centres = round % 3 == 0;
    const auto place = [&](double x, double y) {
      return on_centres ? pixel_vertex(std::floor(x) + 0.5, std::floor(y) + 0.5) : pixel_vertex(x, y);
    };
    const double beside = round % 10 == 0 ? 1e6 : round % 5 == 0 ? 2000.0 : 60.0;
    ScreenVertex a = place(random.range(-beside, 20), random.range(-beside / 10, 50));
    ScreenVertex b = place(random.range(200, 300 + beside), random.range(-10, 40 + beside / 10));
    ScreenVertex c = place(b.x / 256.0 + random.range(-30, 30), b.y / 256.0 + random.range(-3, 3));
    if (round % 7 == 0) b.y = a.y;
    if (round % 11 == 0) c.x = b.x;
    const auto depth_at = [](std::int64_t x, std::int64_t y) {
      return static_cast<std::uint32_t>(2000000000 + 4 * x + 3 * y);
    };
    for (ScreenVertex* v : {&a, &b, &c}) v->depth = depth_at(v->x, v->y);
    const ScreenSoup soup = one_triangle(a, b, c, Culling::kNone, kWide);
    if (doubled_area(a, b, c) < 0) std::swap(b, c);
    const VisibilityBuffer buffer = draw(soup, kWide);
    const auto is_inside = [](const ScreenVertex& from, const ScreenVertex& to, std::int64_t x, std::int64_t y) {
      const std::int64_t dx = std::int64_t{to.x} - from.x, dy = std::int64_t{to.y} - from.y;
      const std::int64_t side = dx * (y - from.y) - dy * (x - from.x);
      return side > 0 || (side == 0 && (dy < 0 || (dy == 0 && dx > 0)));  // a left edge, or a top one
    };
    for (std::uint32_t y = 0; y < kWide.height; ++y) {
      for (std::uint32_t x = 0; x < kWide.width; ++x) {
        const std::int64_t px = std::int64_t{x} * 256 + 128, py = std::int64_t{y} * 256 + 128;
        const bool is_covered =
            doubled_area(a, b, c) != 0 && is_inside(a, b, px, py) && is_inside(b, c, px, py) && is_inside(c, a, px, py);
        drawn += is_covered ? 1 : 0;
        ASSERT_EQ(buffer.item[y * kWide.width + x] != VisibilityBuffer::kNothing, is_covered)
            << "round " << round << " pixel " << x << "," << y;
        if (!is_covered) continue;
        ASSERT_EQ(buffer.depth[y * kWide.width + x], depth_at(px, py)) << "round " << round;
      }
    }
  }
  EXPECT_GT(drawn, 100000);
}

TEST(Raster, GridsOfTrianglesCoverThePictureExactlyOnce) {
  test::Random random(99);
  for (int round = 0; round < 20; ++round) {
    // A jittered grid larger than the picture; each cell is split along a random diagonal.
    constexpr int kCells = 12;
    std::vector<ScreenVertex> points;
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) {
        points.push_back(pixel_vertex(-8 + 80.0 * (i + random.range(-0.3, 0.3)) / kCells,
                                      -8 + 80.0 * (j + random.range(-0.3, 0.3)) / kCells));
      }
    }
    ScreenSoup soup;
    std::uint32_t id = 0;
    for (int j = 0; j < kCells; ++j) {
      for (int i = 0; i < kCells; ++i) {
        const auto at = [&](int x, int y) {
          const int index = (j + y) * (kCells + 1) + i + x;
          return points[static_cast<std::size_t>(index)];
        };
        const bool is_flipped = random.next() % 2 == 0;
        const ScreenVertex a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
        if (is_flipped) {
          add_snapped(a, b, c, Culling::kNone, {0, id++}, kSize, soup);
          add_snapped(a, c, d, Culling::kNone, {0, id++}, kSize, soup);
        } else {
          add_snapped(a, b, d, Culling::kNone, {0, id++}, kSize, soup);
          add_snapped(b, c, d, Culling::kNone, {0, id++}, kSize, soup);
        }
      }
    }
    for (const int count : test::count_coverage(soup, kSize)) ASSERT_EQ(count, 1) << "round " << round;
  }
}

TEST(Raster, DegenerateTrianglesDrawNothing) {
  const ScreenVertex a = pixel_vertex(3, 3), b = pixel_vertex(20, 20), c = pixel_vertex(40, 40);
  EXPECT_TRUE(one_triangle(a, a, a).triangles.empty());
  EXPECT_TRUE(one_triangle(a, b, b).triangles.empty());
  EXPECT_TRUE(one_triangle(a, b, c).triangles.empty());  // collinear
  EXPECT_EQ(test::count_drawn(test::draw(
                one_triangle(pixel_vertex(3.6, 3.6), pixel_vertex(3.9, 3.6), pixel_vertex(3.6, 3.9)), kSize)),
            0u);
}

TEST(Raster, CullingFollowsTheOrientation) {
  const ScreenVertex a = pixel_vertex(4, 4), b = pixel_vertex(30, 4), c = pixel_vertex(4, 30);
  ASSERT_GT(doubled_area(a, b, c), 0);  // clockwise on the screen
  EXPECT_TRUE(one_triangle(a, b, c, Culling::kClockwise).triangles.empty());
  EXPECT_EQ(one_triangle(a, c, b, Culling::kClockwise).triangles.size(), 1u);
  EXPECT_EQ(one_triangle(a, b, c, Culling::kCounterClockwise).triangles.size(), 1u);
  EXPECT_TRUE(one_triangle(a, c, b, Culling::kCounterClockwise).triangles.empty());
  EXPECT_EQ(one_triangle(a, c, b, Culling::kNone).triangles.size(), 1u);
}

TEST(Raster, NearerTrianglesWinAndEqualDepthsGoToTheLowestKey) {
  const auto square = [](std::uint32_t depth, TriangleKey key, ScreenSoup& soup) {
    add_snapped(pixel_vertex(2, 2, depth), pixel_vertex(60, 2, depth), pixel_vertex(2, 60, depth), Culling::kNone, key,
                kSize, soup);
  };
  ScreenSoup soup;
  square(500, {3, 0}, soup);
  square(900, {7, 1}, soup);
  square(900, {7, 0}, soup);
  square(900, {9, 0}, soup);
  square(100, {0, 0}, soup);
  std::vector<std::size_t> order = {0, 1, 2, 3, 4};
  do {
    ScreenSoup shuffled;
    for (const std::size_t i : order) shuffled.triangles.push_back(soup.triangles[i]);
    const VisibilityBuffer buffer = test::draw(shuffled, kSize);
    EXPECT_EQ(buffer.item[10 * 64 + 10], 7u);
    EXPECT_EQ(buffer.triangle[10 * 64 + 10], 0u);
    EXPECT_EQ(buffer.depth[10 * 64 + 10], 900u);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Raster, AVertexAtTheFarEndIsStillDrawn) {
  const ScreenSoup soup = one_triangle(pixel_vertex(2, 2, 0), pixel_vertex(60, 2, 0), pixel_vertex(2, 60, 0));
  EXPECT_EQ(test::draw(soup, kSize).item[10 * 64 + 10], 0u);
}

TEST(Raster, DepthIsInterpolatedExactly) {
  // A plane of depth over the picture: depth = 1000 x + 37 y in pixels is met exactly at every centre.
  const auto vertex = [](int x, int y) { return pixel_vertex(x, y, static_cast<std::uint32_t>(1000 * x + 38 * y)); };
  ScreenSoup soup;
  add_snapped(vertex(0, 0), vertex(64, 0), vertex(64, 64), Culling::kNone, {0, 0}, kSize, soup);
  add_snapped(vertex(0, 0), vertex(64, 64), vertex(0, 64), Culling::kNone, {0, 1}, kSize, soup);
  const VisibilityBuffer buffer = test::draw(soup, kSize);
  for (std::uint32_t y = 0; y < 64; ++y) {
    for (std::uint32_t x = 0; x < 64; ++x) ASSERT_EQ(buffer.depth[y * 64 + x], 1000 * x + 500 + 38 * y + 19);
  }
}

TEST(Raster, WideAndNarrowDepthArithmeticAgree) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    ScreenTriangle t;
    for (ScreenVertex& v : t.v) v.depth = static_cast<std::uint32_t>(random.next());
    const std::int64_t w[3] = {random.between(0, 1 << 28), random.between(0, 1 << 28), random.between(1, 1 << 28)};
    const std::int64_t area = w[0] + w[1] + w[2];
    const std::int64_t wide[3] = {w[0] << 30, w[1] << 30, w[2] << 30};
    EXPECT_EQ(interpolate_depth(t, w, area), interpolate_depth(t, wide, area << 30));
    const auto [low, high] = std::minmax({t.v[0].depth, t.v[1].depth, t.v[2].depth});
    EXPECT_GE(interpolate_depth(t, w, area), low);
    EXPECT_LE(interpolate_depth(t, w, area), high);
  }
}

TEST(Raster, OnePixelAndOddPicturesAreDrawn) {
  for (const ImageSize size :
       {ImageSize{1, 1}, ImageSize{1, 7}, ImageSize{7, 1}, ImageSize{13, 17}, ImageSize{3, 33}}) {
    ScreenSoup soup;
    const ScreenVertex a{-100000, -100000, 5}, b{500000, -100000, 5}, c{-100000, 500000, 5};
    add_snapped(a, b, c, Culling::kNone, {0, 0}, size, soup);
    EXPECT_EQ(test::count_drawn(test::draw(soup, size)), std::size_t{size.width} * size.height);
  }
}

TEST(Raster, OffScreenTrianglesAreLeftOut) {
  EXPECT_TRUE(one_triangle(pixel_vertex(-30, 4), pixel_vertex(-2, 4), pixel_vertex(-9, 40)).triangles.empty());
  EXPECT_TRUE(one_triangle(pixel_vertex(70, 4), pixel_vertex(90, 4), pixel_vertex(80, 40)).triangles.empty());
  EXPECT_TRUE(one_triangle(pixel_vertex(3, 64.6), pixel_vertex(9, 64.6), pixel_vertex(3, 90)).triangles.empty());
}

TEST(Raster, LargestCoordinatesDoNotOverflow) {
  constexpr std::int32_t kFar = 1 << 28;
  const ScreenSoup soup = one_triangle({-kFar, -kFar, 7}, {kFar, -kFar, 7}, {-kFar, kFar, 7});
  const ScreenSoup rest = one_triangle({kFar, -kFar, 7}, {kFar, kFar, 7}, {-kFar, kFar, 7});
  const std::size_t drawn = test::count_drawn(test::draw(soup, kSize));
  EXPECT_EQ(drawn + test::count_drawn(test::draw(rest, kSize)), 64u * 64u);
}

TEST(Raster, PixelsBetweenAreThoseWhoseCentresLieThere) {
  for (std::int32_t low = -600; low <= 600; low += 7) {
    for (std::int32_t high = low; high <= 700; high += 13) {
      const PixelRange range = pixels_between(low, high, 2);
      for (std::int32_t p = 0; p < 2; ++p) {
        const bool is_inside = 256 * p + 128 >= low && 256 * p + 128 <= high;
        EXPECT_EQ(p >= range.first && p <= range.last, is_inside);
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::draw
