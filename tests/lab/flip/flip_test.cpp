// SPDX-License-Identifier: GPL-3.0-or-later
// FLIP against closed forms: what its constants make of pictures whose filters are known beforehand.
#include "lab/flip/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lab/flip/colors.h"

namespace meshlode::lab {
namespace {

using Color = std::array<std::uint8_t, 3>;

std::vector<std::uint8_t> uniform(std::uint32_t width, std::uint32_t height, const Color& color) {
  std::vector<std::uint8_t> rgba;
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
    rgba.insert(rgba.end(), {color[0], color[1], color[2], 255});
  }
  return rgba;
}

Vec3d linear(const Color& c) {
  return {linear_of_srgb(c[0]), linear_of_srgb(c[1]), linear_of_srgb(c[2])};
}

/// The paper's curve, written down once more.
double compressed(double distance) {
  const double largest = std::pow(203.3, 0.7);  // green to blue, to four digits: see GreenAndBlueAreFarthestApart
  const double d = std::pow(distance, 0.7), knee = 0.4 * largest;
  return d < knee ? 0.95 * d / knee : 0.95 + 0.05 * (d - knee) / (largest - knee);
}

TEST(FlipColors, WhiteIsWhiteInEverySpace) {
  const Vec3d opponent = ycxcz_of_linear(Vec3d(1.0));
  EXPECT_NEAR(opponent.x, 100.0, 1e-12);
  EXPECT_NEAR(opponent.y, 0.0, 1e-12);
  EXPECT_NEAR(opponent.z, 0.0, 1e-12);
  const Vec3d lab = hunt_lab_of_linear(Vec3d(1.0));
  EXPECT_NEAR(lab.x, 100.0, 1e-12);
  EXPECT_NEAR(std::hypot(lab.y, lab.z), 0.0, 1e-10);
  EXPECT_NEAR(hunt_lab_of_linear(Vec3d(0.0)).x, 0.0, 1e-12);
}

TEST(FlipColors, OpponentSpaceGoesBackToLight) {
  for (const Vec3d& rgb : {Vec3d(0.2, 0.5, 0.9), Vec3d(1.0, 0.0, 0.0), Vec3d(0.01, 0.99, 0.3)}) {
    EXPECT_LT(glm::length(linear_of_ycxcz(ycxcz_of_linear(rgb)) - rgb), 1e-13);
  }
}

/// L*a*b* of the primaries stands in every table; the Hunt effect scales a* and b* by L*/100.
TEST(FlipColors, PrimariesAreWhereTablesHaveThem) {
  const Vec3d green = hunt_lab_of_linear({0.0, 1.0, 0.0}), blue = hunt_lab_of_linear({0.0, 0.0, 1.0});
  EXPECT_NEAR(green.x, 87.73, 0.02);
  EXPECT_NEAR(green.y, -86.18 * 0.8773, 0.05);
  EXPECT_NEAR(green.z, 83.18 * 0.8773, 0.05);
  EXPECT_NEAR(blue.x, 32.30, 0.02);
  EXPECT_NEAR(blue.y, 79.19 * 0.3230, 0.05);
  EXPECT_NEAR(blue.z, -107.86 * 0.3230, 0.05);
  EXPECT_NEAR(hyab(green, blue), 203.3, 0.1);
}

TEST(Flip, EqualPicturesDoNotDiffer) {
  std::vector<std::uint8_t> rgba;
  for (std::uint32_t i = 0; i < 31 * 17; ++i) {
    rgba.insert(rgba.end(), {std::uint8_t(i * 7), std::uint8_t(i * 13), std::uint8_t(i * 29), 255});
  }
  for (const double d : flip(rgba, rgba, 31, 17).difference) EXPECT_EQ(d, 0.0);
}

TEST(Flip, TransparencyIsNotLookedAt) {
  auto a = uniform(8, 8, {10, 20, 30}), b = a;
  for (std::size_t i = 3; i < b.size(); i += 4) b[i] = 0;
  EXPECT_EQ(pool(flip(a, b, 8, 8)).max, 0.0);
}

/// A blur of one colour is that colour and there are no features: what is left is the compressed HyAB distance.
TEST(Flip, OneColourAgainstAnotherIsTheirCompressedDistance) {
  const std::array<std::array<Color, 2>, 5> pairs{{{{{0, 0, 0}, {255, 255, 255}}},
                                                   {{{0, 255, 0}, {0, 0, 255}}},
                                                   {{{100, 100, 100}, {110, 100, 100}}},
                                                   {{{200, 30, 30}, {30, 200, 30}}},
                                                   {{{128, 128, 128}, {129, 129, 129}}}}};
  for (const auto& [a, b] : pairs) {
    const FlipPicture picture = flip(uniform(40, 30, a), uniform(40, 30, b), 40, 30);
    const double expected = compressed(hyab(hunt_lab_of_linear(linear(a)), hunt_lab_of_linear(linear(b))));
    ASSERT_EQ(picture.difference.size(), 1200U);
    for (const double d : picture.difference) EXPECT_NEAR(d, expected, 2e-5);
  }
}

/// 100^0.7 = 25.119 lies beyond the knee.
TEST(Flip, BlackAgainstWhite) {
  const FlipPool pooled = pool(flip(uniform(16, 16, {0, 0, 0}), uniform(16, 16, {255, 255, 255}), 16, 16));
  EXPECT_NEAR(pooled.mean, 0.9674, 1e-3);
  EXPECT_NEAR(pooled.weighted_median, pooled.mean, 1e-9);
  EXPECT_NEAR(pooled.max, pooled.mean, 1e-9);
}

TEST(Flip, GreenAndBlueAreFarthestApart) {
  EXPECT_NEAR(pool(flip(uniform(4, 4, {0, 255, 0}), uniform(4, 4, {0, 0, 255}), 4, 4)).mean, 1.0, 1e-9);
}

/// Which picture is called the reference changes nothing.
TEST(Flip, IsSymmetric) {
  std::vector<std::uint8_t> a, b;
  for (std::uint32_t i = 0; i < 40 * 25; ++i) {
    a.insert(a.end(), {std::uint8_t(i * 5), std::uint8_t(i * 3), std::uint8_t(i), 255});
    b.insert(b.end(), {std::uint8_t(i * 5 + i % 40), std::uint8_t(i * 2), std::uint8_t(i * 11), 255});
  }
  const FlipPicture there = flip(a, b, 40, 25), back = flip(b, a, 40, 25);
  for (std::size_t i = 0; i < there.difference.size(); ++i) {
    EXPECT_NEAR(there.difference[i], back.difference[i], 1e-12);
  }
}

/// A step from black to white against black alone. At the step, weights of one sign see white: the edge is 1 there,
/// the feature difference 1/sqrt(2) to the power of a half, and the colour difference that of what the blur leaves.
TEST(Flip, AnEdgeThatIsMissingWeighsMoreThanItsColours) {
  const std::uint32_t size = 61, middle = 30;
  auto black = uniform(size, size, {0, 0, 0}), step = black;
  for (std::uint32_t y = 0; y < size; ++y) {
    for (std::uint32_t x = middle + 1; x < size; ++x) std::fill_n(&step[4 * (y * size + x)], 3, std::uint8_t{255});
  }
  const FlipPicture picture = flip(step, black, size, size);
  // Half the blur without the middle pixel's own column is white; one column more and it is the other half.
  const double b = 0.0047, p = kPublishedPixelsPerDegree;
  double all = 0.0, right = 0.0;
  for (int i = -10; i <= 10; ++i) {
    const double w = std::exp(-9.869604401089358 * i * i / (p * p * b));
    all += w;
    if (i > 0) right += w;
  }
  // Black and white mixed are grey in luminance; red-green and blue-yellow are 0 on both sides. 116 t - 16 is linear.
  const double color = compressed(hunt_lab_of_linear(Vec3d(right / all)).x);
  const double at_edge = picture.difference[30 * size + middle];
  const double feature = std::sqrt(1.0 / std::sqrt(2.0));
  EXPECT_NEAR(at_edge, std::pow(color, 1.0 - feature), 2e-3);
  EXPECT_GT(at_edge, color);
  EXPECT_LT(picture.difference[30 * size + 2], 1e-9) << "far from the step both are black";
}

TEST(Flip, PoolsByWhatDiffers) {
  const FlipPicture picture{2, 2, {0.0, 0.1, 0.2, 0.7}};
  const FlipPool pooled = pool(picture);
  EXPECT_DOUBLE_EQ(pooled.mean, 0.25);
  EXPECT_DOUBLE_EQ(pooled.weighted_median, 0.7) << "0.7 holds more than half of the whole difference";
  EXPECT_DOUBLE_EQ(pooled.max, 0.7);
  EXPECT_DOUBLE_EQ(pool({2, 1, {0.0, 0.0}}).weighted_median, 0.0);
}

TEST(Flip, HeatRisesInLightness) {
  FlipPicture picture{256, 1, {}};
  for (int i = 0; i < 256; ++i) picture.difference.push_back(i / 255.0);
  const std::vector<std::uint8_t> rgba = heat_map(picture);
  double before = -1.0;
  for (std::size_t i = 0; i < 256; ++i) {
    const double lightness = hunt_lab_of_linear(linear({rgba[4 * i], rgba[4 * i + 1], rgba[4 * i + 2]})).x;
    EXPECT_GT(lightness, before - 0.6) << i;  // rounding to bytes
    before = lightness;
  }
}

}  // namespace
}  // namespace meshlode::lab
