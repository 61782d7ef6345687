// SPDX-License-Identifier: GPL-3.0-or-later
// Which samples a triangle covers, and sums of squares over pixels: against what a few slow lines say.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/aggregate/alpha_test.h"
#include "builder/aggregate/block_counts.h"
#include "builder/aggregate/sample_mask.h"
#include "builder/aggregate/views.h"

namespace meshlode::builder {
namespace {

constexpr int kSide = 128;

SampleMask picture() {
  MaskBox box;
  const std::array<Vec2d, 2> all{Vec2d(0.0), Vec2d(kSide - 1)};
  box.include(all, kSide);
  return SampleMask(box);
}

bool has(const SampleMask& mask, int x, int y) {
  return (mask.word(x / 64, y) >> static_cast<unsigned>(x % 64) & 1U) != 0;
}

Vec2d random_place(SplitMix64& random, double far) {
  // Some exactly on samples, where rules for edges and corners decide.
  const Vec2d p(random.between(-far, kSide + far), random.between(-far, kSide + far));
  return random.unit() < 0.3 ? Vec2d(std::floor(p.x), std::floor(p.y)) : p;
}

/// What a mask of one triangle has, against the signs of its sides sample by sample.
void expect_inside_alone(const SampleMask& mask, const std::array<Vec2d, 3>& p, const char* which, int round) {
  std::array<std::array<std::int64_t, 2>, 3> q{};
  for (std::size_t k = 0; k < 3; ++k) {
    q[k] = {static_cast<std::int64_t>(std::floor(p[k].x * 256.0 + 0.5)),
            static_cast<std::int64_t>(std::floor(p[k].y * 256.0 + 0.5))};
  }
  // Around it by a sample; that nothing is set farther away the count says.
  const auto around = [&](std::size_t axis) {
    const auto [low, high] = std::minmax({q[0][axis], q[1][axis], q[2][axis]});
    return std::array<int, 2>{static_cast<int>(std::clamp<std::int64_t>(low / 256 - 2, 0, kSide)),
                              static_cast<int>(std::clamp<std::int64_t>(high / 256 + 3, 0, kSide))};
  };
  const auto [first_x, end_x] = around(0);
  const auto [first_y, end_y] = around(1);
  std::uint64_t count = 0;
  for (int y = first_y; y < end_y; ++y) {
    for (int x = first_x; x < end_x; ++x) {
      count += has(mask, x, y) ? 1 : 0;
      int left = 0, right = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& a = q[k];
        const auto& b = q[(k + 1) % 3];
        const std::int64_t side = (b[0] - a[0]) * (256 * y - a[1]) - (b[1] - a[1]) * (256 * x - a[0]);
        left += side > 0 ? 1 : 0;
        right += side < 0 ? 1 : 0;
      }
      if (left == 3 || right == 3) {
        ASSERT_TRUE(has(mask, x, y)) << which << ' ' << round << ": " << x << " " << y;
      } else if (left > 0 && right > 0) {
        ASSERT_FALSE(has(mask, x, y)) << which << ' ' << round << ": " << x << " " << y;
      }
    }
  }
  ASSERT_EQ(mask.count(), count) << which << ' ' << round;
}

TEST(SampleMask, CoversWhatIsInsideBySidesInWholeNumbers) {
  SplitMix64 random(1);
  for (int round = 0; round < 400; ++round) {
    std::array<Vec2d, 3> p;
    for (Vec2d& corner : p) corner = random_place(random, round % 4 == 0 ? 300.0 : 5.0);
    SampleMask mask = picture();
    mask.add_triangle(p);
    expect_inside_alone(mask, p, "large", round);
  }
}

TEST(SampleMask, CoversWhatIsInsideOfTrianglesOfAFewSamplesToo) {
  SplitMix64 random(3);
  const auto everywhere = [](double, double) { return true; };
  for (int round = 0; round < 1500; ++round) {
    // Up to 20 columns wide, across the border of two words, of the picture, and elsewhere.
    const double size = 1.0 + round % 20;
    const Vec2d middle(round % 3 == 0 ? 64.0 : random.between(-3.0, kSide + 3), random.between(-3.0, kSide + 3));
    std::array<Vec2d, 3> p;
    for (Vec2d& corner : p) {
      corner = middle + Vec2d(random.between(-0.5, 0.5) * size, random.between(-1.0, 1.0) * size);
      if (random.unit() < 0.3) corner = Vec2d(std::floor(corner.x), std::floor(corner.y));
    }
    SampleMask mask = picture(), asked = picture();
    mask.add_triangle(p);
    expect_inside_alone(mask, p, "small", round);
    asked.add_triangle(p, {Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1)}, everywhere);
    for (int y = 0; y < kSide; ++y) {
      for (int word = 0; word < 2; ++word) ASSERT_EQ(mask.word(word, y), asked.word(word, y)) << round;
    }
  }
}

TEST(SampleMask, OfTwoTrianglesThatShareAnEdgeASampleIsInOne) {
  SplitMix64 random(2);
  for (int round = 0; round < 400; ++round) {
    const Vec2d a = random_place(random, 5.0), b = random_place(random, 5.0), c = random_place(random, 5.0);
    // Any point of a triangle cuts it into three that are together the whole.
    const Vec2d middle(std::floor((a.x + b.x + c.x) / 3.0), std::floor((a.y + b.y + c.y) / 3.0));
    SampleMask whole = picture();
    whole.add_triangle({a, b, c});
    const auto area = [](const Vec2d& p, const Vec2d& q, const Vec2d& r) {
      return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    const double s0 = area(a, b, middle), s1 = area(b, c, middle), s2 = area(c, a, middle);
    if (!((s0 > 1.0 && s1 > 1.0 && s2 > 1.0) || (s0 < -1.0 && s1 < -1.0 && s2 < -1.0))) continue;
    std::uint64_t sum = 0;
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      SampleMask part = picture();
      part.add_triangle({p, middle, q});
      sum += part.count();
    }
    EXPECT_EQ(sum, whole.count()) << round;
  }
}

TEST(SampleMask, AMaskedTriangleAsksAtTheRightPlace) {
  SampleMask mask = picture(), mirrored = picture();
  const auto near_b = [](double b, double) { return b > 0.5; };
  const std::array<Vec2d, 3> uv{Vec2d(0, 0), Vec2d(1, 0), Vec2d(0, 1)};  // of the second and the third corner
  mask.add_triangle({Vec2d(10.3, 10.2), Vec2d(100.3, 12.2), Vec2d(14.1, 90.7)}, uv, near_b);
  EXPECT_TRUE(has(mask, 90, 13));
  EXPECT_FALSE(has(mask, 15, 70));
  EXPECT_FALSE(has(mask, 12, 12));
  mirrored.add_triangle({Vec2d(10.3, 10.2), Vec2d(14.1, 90.7), Vec2d(100.3, 12.2)}, uv,
                        [](double, double c) { return c > 0.5; });
  EXPECT_EQ(mask.count(), mirrored.count()) << "whichever way round";
}

TEST(AlphaTest, OfARowIsThatOfItsPoints) {
  const auto stripes = [](double u, double v) { return static_cast<int>(std::floor(7.0 * u + 3.0 * v)) % 3 == 0; };
  const AlphaTest test = stripes;
  EXPECT_FALSE(AlphaTest{});
  ASSERT_TRUE(test);
  SplitMix64 random(8);
  for (int round = 0; round < 100; ++round) {
    const Vec2d origin(random.between(0.0, 2.0), random.between(0.0, 2.0)), step(random.between(-0.1, 0.1), 0.03);
    const std::uint64_t asked = random.next();
    const std::uint64_t drawn = test.of_row(origin, step, 64 * round, asked);
    for (int bit = 0; bit < 64; ++bit) {
      const Vec2d at = origin + step * static_cast<double>(64 * round + bit);
      const bool is_asked = (asked >> bit & 1U) != 0;
      ASSERT_EQ((drawn >> bit & 1U) != 0, is_asked && stripes(at.x, at.y)) << round << ' ' << bit;
      EXPECT_EQ(test(at.x, at.y), stripes(at.x, at.y));
    }
  }
  EXPECT_EQ(test.of_row(Vec2d(0.0), Vec2d(0.0), 0, 0), 0U);
}

TEST(BlockCounts, SumsOfSquaresAreThoseOfEveryPixel) {
  SplitMix64 random(5);
  MaskBox box;
  box.end_word = 2;
  box.end_row = 38;
  BlockCounts counts(box);
  std::vector<BlockCounts> halved;  // from the start
  for (unsigned halvings = 1; halvings <= 7; ++halvings) halved.emplace_back(box, halvings);
  std::vector<std::vector<int>> samples(38, std::vector<int>(128, 0));
  for (int y = 0; y < 38; y += 2) {
    for (std::size_t w = 0; w < 2; ++w) {
      for (const int sign : {1, -1}) {
        std::array<std::uint64_t, 2> rows{random.next() & random.next(), random.next() & random.next()};
        counts.add_word(w, static_cast<std::size_t>(y) / 2, rows[0], rows[1], sign);
        for (BlockCounts& each : halved) each.add_word(w, static_cast<std::size_t>(y) / 2, rows[0], rows[1], sign);
        for (std::size_t k = 0; k < 2; ++k) {
          for (unsigned x = 0; x < 64; ++x) {
            samples[static_cast<std::size_t>(y) + k][64 * w + x] += sign * static_cast<int>(rows[k] >> x & 1U);
          }
        }
      }
    }
  }
  std::size_t block = 2;
  for (int octave = 0; octave < 3; ++octave, block *= 2) {
    for (const std::size_t side : {1U, 4U, 6U}) {
      const auto blocks_y = static_cast<int>((38 + block - 1) / block), blocks_x = static_cast<int>(128 / block);
      std::int64_t expected = 0;
      for (int y = 1 - static_cast<int>(side); y < blocks_y; ++y) {
        for (int x = 1 - static_cast<int>(side); x < blocks_x; ++x) {
          std::int64_t sum = 0;
          for (int j = y * static_cast<int>(block); j < (y + static_cast<int>(side)) * static_cast<int>(block); ++j) {
            for (int i = x * static_cast<int>(block); i < (x + static_cast<int>(side)) * static_cast<int>(block); ++i) {
              if (j >= 0 && j < 38 && i >= 0 && i < 128)
                sum += samples[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
            }
          }
          expected += sum * sum;
        }
      }
      if (octave > 0) {
        EXPECT_EQ(halved[static_cast<std::size_t>(octave) - 1].sum_of_squares(side), expected);
      }
      EXPECT_EQ(counts.sum_of_squares(side), expected) << octave << " " << side;
    }
    counts.halve();
  }
  for (std::size_t h = 3; h <= 7; ++h, counts.halve()) {
    for (const std::size_t side : {1U, 4U, 6U})
      EXPECT_EQ(halved[h - 1].sum_of_squares(side), counts.sum_of_squares(side));
  }
}

TEST(BlockCounts, SumsOfSquaresOfFullPixelsDoNotRunOver) {
  // So wide that squares of 16 bits are summed up in several parts, and the largest that there are.
  MaskBox box;
  box.end_word = 300;
  box.end_row = 64;
  for (const int sign : {1, -1}) {
    BlockCounts counts(box);
    for (std::size_t word = 0; word < 300; ++word) {
      for (std::size_t row = 0; row < 32; ++row) counts.add_word(word, row, ~std::uint64_t{0}, ~std::uint64_t{0}, sign);
    }
    std::int64_t columns = 9600, rows = 32, each = 4;
    for (int octave = 0; octave < 3; ++octave, columns /= 2, rows /= 2, each *= 4) {
      for (const std::int64_t side : {4, 6}) {
        // Along a line of n blocks: 1, 2, … side - 1 of them at either end.
        const auto line = [&](std::int64_t n) {
          return (n - side + 1) * side * side + (side - 1) * side * (2 * side - 1) / 3;
        };
        EXPECT_EQ(counts.sum_of_squares(static_cast<std::size_t>(side)), each * each * line(columns) * line(rows))
            << sign << ' ' << octave << ' ' << side;
      }
      counts.halve();
    }
  }
}

TEST(Views, AreUnitAndAtRightAngles) {
  for (const View& view : views()) {
    EXPECT_NEAR(glm::length(view.right), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(view.up), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(view.right, view.up), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace meshlode::builder
