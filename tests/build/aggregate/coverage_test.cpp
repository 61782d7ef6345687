// SPDX-License-Identifier: GPL-3.0-or-later
// Which samples a triangle covers, and sums of squares over pixels: against what a few slow lines say.
#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "build/aggregate/block_counts.h"
#include "build/aggregate/sample_mask.h"
#include "build/aggregate/views.h"

namespace meshlode::build {
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

TEST(SampleMask, CoversWhatIsInsideBySidesInWholeNumbers) {
  SplitMix64 random(1);
  for (int round = 0; round < 400; ++round) {
    std::array<Vec2d, 3> p;
    for (Vec2d& corner : p) corner = random_place(random, round % 4 == 0 ? 300.0 : 5.0);
    SampleMask mask = picture();
    mask.add_triangle(p);
    std::array<std::array<std::int64_t, 2>, 3> q{};
    for (std::size_t k = 0; k < 3; ++k) {
      q[k] = {static_cast<std::int64_t>(std::floor(p[k].x * 256.0 + 0.5)),
              static_cast<std::int64_t>(std::floor(p[k].y * 256.0 + 0.5))};
    }
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        int left = 0, right = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto& a = q[k];
          const auto& b = q[(k + 1) % 3];
          const std::int64_t side = (b[0] - a[0]) * (256 * y - a[1]) - (b[1] - a[1]) * (256 * x - a[0]);
          left += side > 0 ? 1 : 0;
          right += side < 0 ? 1 : 0;
        }
        if (left == 3 || right == 3) {
          ASSERT_TRUE(has(mask, x, y)) << round << ": " << x << " " << y;
        } else if (left > 0 && right > 0) {
          ASSERT_FALSE(has(mask, x, y)) << round << ": " << x << " " << y;
        }
      }
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

TEST(BlockCounts, SumsOfSquaresAreThoseOfEveryPixel) {
  SplitMix64 random(5);
  MaskBox box;
  box.end_word = 2;
  box.end_row = 38;
  BlockCounts counts(box);
  std::vector<std::vector<int>> samples(38, std::vector<int>(128, 0));
  for (int y = 0; y < 38; y += 2) {
    for (std::size_t w = 0; w < 2; ++w) {
      for (const int sign : {1, -1}) {
        std::array<std::uint64_t, 2> rows{random.next() & random.next(), random.next() & random.next()};
        counts.add_word(w, static_cast<std::size_t>(y) / 2, rows[0], rows[1], sign);
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
      EXPECT_EQ(counts.sum_of_squares(side), expected) << octave << " " << side;
    }
    counts.halve();
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
}  // namespace meshlode::build
