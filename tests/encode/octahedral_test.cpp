// SPDX-License-Identifier: GPL-3.0-or-later
#include "encode/octahedral.h"

#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "decode/octahedral.h"
#include "support/random.h"

namespace meshlode {
namespace {

using Pair = std::array<std::int32_t, 2>;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// The angle between a direction and the stored one, accurate for small angles too.
double angle(const Vec3d& direction, const Pair& stored, std::uint32_t bits) {
  const auto p = decode_octahedral_point(stored[0], stored[1], bits);
  const Vec3d q(p[0], p[1], p[2]);
  return std::atan2(glm::length(glm::cross(direction, q)), glm::dot(direction, q));
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
Vec3f spread_direction(int i, int count) {
  const double z = 1.0 - (2.0 * i + 1.0) / count;
  const double r = std::sqrt(1.0 - z * z);
  const double turn = 2.399963229728653 * i;
  return {static_cast<float>(r * std::cos(turn)), static_cast<float>(r * std::sin(turn)), static_cast<float>(z)};
}

// The plane of an octahedron's face lies M / sqrt(3) from the centre and carries a lattice of triangles with side
// sqrt(2), whose points leave no place farther than sqrt(2) / sqrt(3) away. The angle is below the quotient.
TEST(Octahedral, ErrorIsBelowTheClosedForm) {
  for (std::uint32_t bits = 4; bits <= 16; ++bits) {
    const double bound = std::sqrt(2.0) / ((1 << (bits - 1)) - 1);
    constexpr int kCount = 200000;
    double worst = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const Vec3f n = spread_direction(i, kCount);
      worst = std::max(worst, angle(Vec3d(n), encode_octahedral(n, bits), bits));
    }
    EXPECT_LE(worst, bound) << bits << " bits";
    EXPECT_GE(worst, 0.8 * bound) << bits << " bits: the bound is nearly reached in the middle of a face";
  }
}

TEST(Octahedral, ElevenBitsKeepATenthOfADegree) {
  EXPECT_LE(std::sqrt(2.0) / ((1 << 10) - 1), 0.1 * 3.14159265358979 / 180.0);
}

// Against every representable direction, not only those nearby.
TEST(Octahedral, NoOtherIntegersWouldBeNearer) {
  test::Random random(7);
  for (const std::uint32_t bits : {4U, 5U, 6U}) {
    const std::int32_t most = (1 << bits) - 2;
    for (int i = 0; i < 3000; ++i) {
      Vec3f n(static_cast<float>(random.signed_unit()), static_cast<float>(random.signed_unit()),
              static_cast<float>(random.signed_unit()));
      if (i % 3 == 0) n[i / 3 % 3] *= 1e-3F;  // near the folds
      if (i % 7 == 0) n[(i / 7 + 1) % 3] *= 1e-3F;
      double best = 4.0;
      for (std::int32_t a = 0; a <= most; ++a) {
        for (std::int32_t b = 0; b <= most; ++b) best = std::min(best, angle(Vec3d(n), {a, b}, bits));
      }
      ASSERT_LE(angle(Vec3d(n), encode_octahedral(n, bits), bits), best + 1e-12) << "seed 7, direction " << i;
    }
  }
}

TEST(Octahedral, EveryDirectionHasOnePairOfIntegers) {  // I3
  for (const std::uint32_t bits : {4U, 5U, 8U}) {
    const std::int32_t most = (1 << bits) - 2;
    std::map<std::array<std::int32_t, 3>, Pair> canonical;
    for (std::int32_t a = 0; a <= most; ++a) {
      for (std::int32_t b = 0; b <= most; ++b) {
        const auto p = decode_octahedral_point(a, b, bits);
        const Pair pair = encode_octahedral(
            {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])}, bits);
        ASSERT_EQ(decode_octahedral_point(pair[0], pair[1], bits), p) << a << " " << b;
        ASSERT_EQ(canonical.emplace(p, pair).first->second, pair) << a << " " << b;
      }
    }
    // The integer points of an octahedron of radius M: 4 M² + 2.
    EXPECT_EQ(canonical.size(), static_cast<std::size_t>(most) * static_cast<std::size_t>(most) + 2U);
  }
}

TEST(Octahedral, TheDecodedNormalEncodesToItself) {
  test::Random random(11);
  for (const std::uint32_t bits : {8U, 11U, 16U}) {
    for (int i = 0; i < 20000; ++i) {
      const Pair pair = encode_octahedral({static_cast<float>(random.signed_unit()),
                                           static_cast<float>(random.signed_unit()),
                                           static_cast<float>(random.signed_unit())}, bits);
      EXPECT_EQ(encode_octahedral(decode_octahedral(pair[0], pair[1], bits), bits), pair) << "seed 11";
    }
  }
}

TEST(Octahedral, AxesAreExactAndNegativeZeroIsZero) {
  for (const std::uint32_t bits : {4U, 11U, 16U}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const float sign : {1.0F, -1.0F}) {
        for (const float zero : {0.0F, -0.0F}) {
          Vec3f n(zero);
          n[axis] = sign;
          const Pair pair = encode_octahedral(n, bits);
          EXPECT_EQ(decode_octahedral(pair[0], pair[1], bits)[axis], sign);
          Vec3f plain(0.0F);
          plain[axis] = sign;
          EXPECT_EQ(pair, encode_octahedral(plain, bits));
        }
      }
    }
  }
}

TEST(Octahedral, LengthDoesNotMatter) {
  for (const float scale : {1e-44F, 1e-30F, 1e-3F, 1e10F, 1e37F}) {
    EXPECT_EQ(encode_octahedral({scale, -scale, scale}, 11), encode_octahedral({1.0F, -1.0F, 1.0F}, 11)) << scale;
  }
}

TEST(Octahedral, NormalsThatAreNoneBecomeUp) {
  for (const Vec3f& n : {Vec3f(0.0F), Vec3f(-0.0F), Vec3f(kNan), Vec3f(1.0F, kNan, 0.0F), Vec3f(kInf, 0.0F, 0.0F),
                         Vec3f(-kInf, kInf, kNan)}) {
    const Pair pair = encode_octahedral(n, 11);
    EXPECT_EQ(decode_octahedral(pair[0], pair[1], 11), Vec3f(0.0F, 0.0F, 1.0F));
  }
}

}  // namespace
}  // namespace meshlode
