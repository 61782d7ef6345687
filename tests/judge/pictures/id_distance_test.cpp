// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of ids made by hand: the distance is that of the nearest pixel of the same surface, and what is astray is
// what lies beyond the allowance.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "draw/raster/projection.h"
#include "judge/pictures/id_distance.h"

namespace meshlode::judge {
namespace {

constexpr std::uint64_t kNothing = IdPicture::kBackground;

IdPicture blank(std::uint32_t width, std::uint32_t height, std::uint64_t id = kNothing) {
  const std::size_t pixels = std::size_t{width} * height;
  return {width,
          height,
          std::vector<std::uint64_t>(pixels, id),
          std::vector<std::uint32_t>(pixels, 1U << 31U),
          std::vector<float>(pixels, 0.0F),
          {}};
}

void fill(IdPicture& picture, std::uint32_t left, std::uint32_t top, std::uint32_t right, std::uint32_t bottom,
          std::uint64_t id) {
  for (std::uint32_t y = top; y < bottom; ++y) {
    for (std::uint32_t x = left; x < right; ++x) picture.id[std::size_t{y} * picture.width + x] = id;
  }
}

draw::Projection flat(std::uint32_t width, std::uint32_t height) {
  draw::Projection out;
  out.is_orthographic = true;
  out.far_distance = 1000.0;
  out.size = {width, height};
  return out;
}

/// Of cuts of one pixel: 2.5 pixels are allowed.
IdDistance measure(const IdPicture& a, const IdPicture& b) {
  const draw::Projection projection = flat(a.width, a.height);
  return sum_up(a, b, find_astray(a, b, AllowedPixels(projection, 1.0)));
}

TEST(IdDistance, EqualPicturesHaveNothingAstray) {
  IdPicture picture = blank(40, 30);
  fill(picture, 5, 5, 20, 20, 1);
  fill(picture, 12, 8, 33, 26, 2);
  const IdDistance found = measure(picture, picture);
  EXPECT_EQ(found.astray, 0U);
  EXPECT_EQ(found.farthest_px, 0.0);
  EXPECT_EQ(found.pixels, 15U * 15U + 21U * 18U - 8U * 12U);
}

/// A wall of two surfaces whose border moves: each moved pixel finds its surface as far away as it lies behind the
/// border.
TEST(IdDistance, ABorderMayMoveByWhatIsAllowed) {
  for (std::uint32_t moved = 0; moved < 9; ++moved) {
    IdPicture source = blank(60, 40, 1), cut = source;
    fill(source, 30, 0, 60, 40, 2);
    fill(cut, 30 + moved, 0, 60, 40, 2);
    const IdDistance found = measure(source, cut);
    // Columns 30 … 30 + moved - 1 show 2 in the source, 1 in the cut: from column 30 + k the next 2 of the cut is
    // moved - k away, and the next 1 of the source k + 1. Three rows at the top and bottom are too near to the edge.
    std::uint64_t astray = 0;
    for (std::uint32_t k = 0; k < moved; ++k) astray += std::max(moved - k, k + 1) > 2 ? 40 - 2 * 2 : 0;
    EXPECT_EQ(found.astray, astray) << moved;
    EXPECT_EQ(found.farthest_px, moved > 2 ? moved : 0) << moved;
  }
}

TEST(IdDistance, ASurfaceThatVanishesIsInfinitelyFar) {
  IdPicture source = blank(60, 40, 1), cut = source;
  fill(source, 20, 10, 30, 20, 2);
  const IdDistance found = measure(source, cut);
  EXPECT_EQ(found.astray, 100U);
  EXPECT_TRUE(std::isinf(found.farthest_px));
  EXPECT_EQ(measure(cut, source).astray, 100U) << "the other way around too";
}

/// What comes before the background or goes there is found by its own id; the background finds nothing.
TEST(IdDistance, TheBackgroundIsNoSurface) {
  IdPicture source = blank(60, 40), cut = source;
  fill(source, 20, 10, 40, 30, 1);
  fill(cut, 22, 12, 38, 28, 1);
  EXPECT_EQ(measure(source, cut).astray, 4U) << "a silhouette moves by two pixels, which corners see from 2.8 away";
  fill(cut, 20, 10, 40, 30, kNothing);
  EXPECT_EQ(measure(source, cut).astray, 400U);
  EXPECT_EQ(measure(source, cut).pixels, 400U);
  // A hole of 8 by 8 in the middle of a surface: what is farther inside than 2.5 pixels.
  cut = source;
  fill(cut, 26, 16, 34, 24, kNothing);
  EXPECT_EQ(measure(source, cut).astray, 16U);
}

TEST(IdDistance, BeyondThePicturesEdgeNothingIsKnown) {
  IdPicture source = blank(60, 40, 1), cut = source;
  fill(source, 0, 0, 2, 40, 2);
  EXPECT_EQ(measure(source, cut).astray, 0U);
  fill(source, 0, 0, 4, 40, 2);
  EXPECT_EQ(measure(source, cut).astray, 2U * 36U) << "two columns are three pixels from what lies beyond";
}

/// A line in one picture, of which the other shows nothing by single pixels, and a thread in its finer picture: within
/// what is allowed the line is no longer astray. A wall is, whatever threads there are.
TEST(IdDistance, WhatIsNarrowIsLookedForInFinerPictures) {
  constexpr std::uint32_t kFiner = 4, kLine = 30, kTop = 5, kBottom = 55;
  const draw::Projection projection = flat(60, 60);
  const AllowedPixels allowed(projection, 1.0);  // 2.5 pixels: 10 finer ones
  const auto left = [&](std::uint32_t width, std::uint32_t fine_pixels_away, bool is_of_cut) {
    const IdPicture nothing = blank(60, 60);
    IdPicture line = blank(60, 60), thread = blank(60 * kFiner, 60 * kFiner);
    fill(line, kLine, kTop, kLine + width, kBottom, 1);
    const std::uint32_t at = kLine * kFiner + kFiner / 2 + fine_pixels_away;
    fill(thread, at, 0, at + 1, 60 * kFiner, 1);
    const IdPicture& source = is_of_cut ? nothing : line;
    const IdPicture& cut = is_of_cut ? line : nothing;
    std::vector<AstrayPixel> astray = find_astray(source, cut, allowed);
    EXPECT_EQ(astray.size(), std::size_t{width} * (kBottom - kTop));
    for (const AstrayPixel& pixel : astray)
      EXPECT_TRUE(pixel.is_of_cut == is_of_cut && pixel.is_of_source != is_of_cut);
    const IdPicture none = blank(60 * kFiner, 60 * kFiner);
    dismiss_narrow(source, cut, is_of_cut ? thread : none, is_of_cut ? none : thread, kFiner, allowed, astray);
    return astray.size();
  };
  for (const bool is_of_cut : {false, true}) {
    EXPECT_EQ(left(1, 0, is_of_cut), 0U);
    EXPECT_EQ(left(2, 0, is_of_cut), 0U);
    EXPECT_EQ(left(1, 10, is_of_cut), 0U) << "just what is allowed";
    EXPECT_EQ(left(1, 11, is_of_cut), 50U);
    EXPECT_EQ(left(3, 0, is_of_cut), 150U) << "a wall";
  }
}

/// Pixels of both: each has to be found.
TEST(IdDistance, EachOfTwoNarrowSurfacesHasToBeThere) {
  const draw::Projection projection = flat(60, 60);
  const AllowedPixels allowed(projection, 1.0);
  IdPicture source = blank(60, 60), cut = blank(60, 60), finer_source = blank(240, 240), finer_cut = blank(240, 240);
  fill(source, 30, 5, 31, 55, 1);
  fill(cut, 30, 5, 31, 55, 2);
  fill(finer_source, 122, 0, 123, 240, 2);
  std::vector<AstrayPixel> astray = find_astray(source, cut, allowed);
  dismiss_narrow(source, cut, finer_source, finer_cut, 4, allowed, astray);
  EXPECT_EQ(astray.size(), 50U);
  fill(finer_cut, 122, 0, 123, 120, 1);
  dismiss_narrow(source, cut, finer_source, finer_cut, 4, allowed, astray);
  EXPECT_EQ(astray.size(), 23U) << "the upper part is there, and 2.5 pixels more";
}

/// By the definition, with all pixels against all.
TEST(IdDistance, RandomPicturesHaveTheDistancesOfTheDefinition) {
  SplitMix64 random(4);
  for (int round = 0; round < 40; ++round) {
    const auto width = static_cast<std::uint32_t>(20 + random.below(14)),
               height = 22 + static_cast<std::uint32_t>(random.below(9));
    IdPicture pictures[2] = {blank(width, height), blank(width, height)};
    for (IdPicture& picture : pictures) {
      for (int piece = 0; piece < 6; ++piece) {
        const auto x = static_cast<std::uint32_t>(random.below(width - 3)),
                   y = static_cast<std::uint32_t>(random.below(height - 3));
        fill(picture, x, y, std::min(width, x + 1 + static_cast<std::uint32_t>(random.below(9))),
             std::min(height, y + 1 + static_cast<std::uint32_t>(random.below(9))),
             random.below(4) == 0 ? kNothing : 1 + random.below(5));
      }
    }
    IdDistance expected;
    for (std::uint32_t y = 0; y < height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        const std::size_t at = std::size_t{y} * width + x;
        double worst = 0.0;
        for (int k = 0; k < 2; ++k) {
          if (pictures[k].id[at] == kNothing) continue;
          double nearest = HUGE_VAL;
          for (std::uint32_t v = 0; v < height; ++v) {
            for (std::uint32_t u = 0; u < width; ++u) {
              if (pictures[1 - k].id[std::size_t{v} * width + u] == pictures[k].id[at]) {
                nearest = std::min(nearest, std::hypot(u * 1.0 - x, v * 1.0 - y));
              }
            }
          }
          worst = std::max(worst, nearest);
        }
        expected.pixels += pictures[0].id[at] != kNothing || pictures[1].id[at] != kNothing ? 1 : 0;
        const bool is_inside = x >= 2 && y >= 2 && x + 2 < width && y + 2 < height;
        if (!is_inside || worst <= 2.5) continue;
        ++expected.astray;
        expected.farthest_px = std::max(expected.farthest_px, worst);
      }
    }
    const IdDistance found = measure(pictures[0], pictures[1]);
    EXPECT_EQ(found.pixels, expected.pixels);
    EXPECT_EQ(found.astray, expected.astray);
    EXPECT_DOUBLE_EQ(found.farthest_px, expected.farthest_px);
  }
}

/// A point that is displaced by an angle of one pixel moves by a pixel in the middle of the picture and by 1 / cos² at
/// its corner, outwards.
TEST(IdDistance, ThePictureStretchesWhatIsAllowedTowardsItsCorners) {
  run::Camera camera;
  camera.width = camera.height = 301;
  camera.fovy = 1.6;
  camera.near_distance = 0.5;
  const auto projection = draw::make_projection(camera);
  ASSERT_TRUE(projection);
  const IdPicture picture = blank(301, 301, 1);  // half of the depth: at twice the near distance
  const AllowedPixels allowed(*projection, 3.0);
  EXPECT_NEAR(allowed.at(picture, 150 * 301 + 150), 4.5, 1e-9);
  const double k = projection->pixels_per_unit, corner = std::sqrt(2.0) * 150.0;
  const double turned = k * std::tan(std::atan(corner / k) + 1e-6) - corner;
  EXPECT_NEAR(allowed.at(picture, 0) - 1.5, 3.0 * turned / (k * 1e-6), 1e-3);
}

TEST(IdDistance, Level0sOwnDeviationAndTheNearPlaneAllowMore) {
  run::Camera camera;
  camera.width = camera.height = 101;
  camera.near_distance = 0.5;
  const auto projection = draw::make_projection(camera);
  ASSERT_TRUE(projection);
  IdPicture picture = blank(101, 101, 1);
  const std::size_t middle = 50 * 101 + 50;
  picture.level0[middle] = 0.1F;  // at a distance of 1
  EXPECT_NEAR(AllowedPixels(*projection, 2.0).at(picture, middle), 1.5 + 0.1 * projection->pixels_per_unit, 1e-5);
  picture.level0[middle] = 0.0F;
  picture.depth[middle] = 4200000000U;  // 2% behind the near plane, some two pixels
  EXPECT_TRUE(std::isinf(AllowedPixels(*projection, 4.0).at(picture, middle)));
  EXPECT_FALSE(std::isinf(AllowedPixels(*projection, 1.0).at(picture, middle)));
  picture.id[middle] = kNothing;
  EXPECT_EQ(AllowedPixels(*projection, 4.0).at(picture, middle), 0.0);
}

}  // namespace
}  // namespace meshlode::judge
