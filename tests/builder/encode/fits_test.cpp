// SPDX-License-Identifier: GPL-3.0-or-later
// Fits are exact to undo, whatever the values, and take out what is affine.
#include "builder/encode/fits.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>
#include <meshlode/format.h>

#include "support/random.h"

namespace meshlode::builder {
namespace {

using Position = std::array<std::int32_t, 3>;

/// docs/reference/format.md, 13, in 64 bits: nothing may have wrapped.
void expect_undone(const std::vector<Position>& positions, const PositionFit& fit) {
  const std::size_t u = fit.axis == 0 ? 1 : 0;
  const std::size_t v = fit.axis == 2 ? 1 : 2;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_LT(std::uint64_t{fit.raw[i][axis]}, std::uint64_t{1} << fit.range[axis].bits);
      std::int64_t value = std::int64_t{fit.range[axis].minimum} + fit.raw[i][axis];
      if (axis == fit.axis) {
        value += (std::int64_t{fit.slope[0]} * fit.raw[i][u] + std::int64_t{fit.slope[1]} * fit.raw[i][v]) >>
                 format::kShearShift;
      }
      ASSERT_EQ(value, positions[i][axis]);
    }
  }
  for (const ValueRange& range : fit.range) {
    EXPECT_LE(range.bits, 24U);
    EXPECT_LT(std::abs(std::int64_t{range.minimum}), 1 << 23);
  }
}

void expect_undone(const std::vector<std::int32_t>& values, const std::vector<RawPosition>& positions,
                   const UvFit& fit) {
  ASSERT_LE(fit.range.bits, 25U);
  ASSERT_LT(fit.shift, 32U);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_LE(std::abs(fit.slope[k]), 511);
      sum += static_cast<std::uint32_t>(fit.slope[k]) * positions[i][k];
    }
    const std::int32_t fitted = fit.has_slope ? static_cast<std::int32_t>(sum) >> fit.shift : 0;
    ASSERT_EQ(static_cast<std::int32_t>(static_cast<std::uint32_t>(fit.range.minimum) + fit.residual[i] +
                                        static_cast<std::uint32_t>(fitted)),
              values[i]);
  }
}

TEST(Fits, APlaneLosesAnAxis) {
  std::vector<Position> plane;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) plane.push_back({100 * x - 17, 100 * y + 5, (100 * x * 3 + 100 * y * 5) / 8 + 1000});
  }
  const PositionFit fit = fit_positions(plane);
  expect_undone(plane, fit);
  EXPECT_LE(fit.range[fit.axis].bits, 3U);
}

TEST(Fits, AnyPositionsComeBack) {
  test::Random random(31);
  for (int round = 0; round < 400; ++round) {
    std::vector<Position> positions;
    const auto count = 1 + random.below(256);
    const auto size = 1 + random.below(std::uint64_t{1} << random.below(24));
    const auto offset = static_cast<std::int32_t>(random.below(1 << 23)) - (1 << 22);
    for (std::uint64_t i = 0; i < count; ++i) {
      Position p{};
      for (std::int32_t& c : p) {
        c = std::clamp(offset + static_cast<std::int32_t>(random.below(size)), -8388607, 8388607);
      }
      if (round % 3 == 0) p[2] = p[0] / 3 - p[1] / 5;
      if (round % 7 == 0) p[1] = 8388607;
      positions.push_back(p);
    }
    expect_undone(positions, fit_positions(positions));
  }
}

TEST(Fits, ExtremePositionsComeBack) {
  constexpr std::int32_t kMost = (1 << 23) - 1;
  const std::vector<Position> corners{
      {-kMost, -kMost, -kMost}, {kMost, kMost, kMost}, {kMost, -kMost, kMost}, {-kMost, kMost, -kMost}};
  expect_undone(corners, fit_positions(corners));
  const std::vector<Position> one{{kMost, -kMost, 0}};
  expect_undone(one, fit_positions(one));
  EXPECT_EQ(fit_positions(one).range[0].bits, 0U);
}

TEST(Fits, AnAffineMapLeavesNextToNothing) {
  test::Random random(37);
  std::vector<RawPosition> positions;
  std::vector<std::int32_t> values;
  for (int i = 0; i < 100; ++i) {
    const RawPosition p{static_cast<std::uint32_t>(random.below(100)), static_cast<std::uint32_t>(random.below(100)),
                        static_cast<std::uint32_t>(random.below(4))};
    positions.push_back(p);
    values.push_back(static_cast<std::int32_t>(5 * p[0]) - static_cast<std::int32_t>(7 * p[1]) + 12345);
  }
  const UvFit fit = fit_uv(values, positions, true);
  expect_undone(values, positions, fit);
  EXPECT_TRUE(fit.has_slope);
  EXPECT_LE(fit.range.bits, 2U);
  EXPECT_FALSE(fit_uv(values, positions, false).has_slope);
}

/// Bits of the least range that holds the values as they are.
std::uint32_t plain_bits(const std::vector<std::int32_t>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  std::uint32_t bits = 0;
  while ((std::int64_t{1} << bits) <= std::int64_t{*most} - *least) ++bits;
  return bits;
}

// A slope takes room in the cluster's head: it is kept where it makes values shorter, and only there.
TEST(Fits, ASlopeIsKeptOnlyWhereItSavesBits) {
  test::Random random(43);
  int sloped = 0, plain = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<RawPosition> positions;
    std::vector<std::int32_t> values;
    const std::uint64_t noise = 1 + random.below(std::uint64_t{1} << random.below(12));
    for (std::uint64_t i = 0; i < 4 + random.below(60); ++i) {
      positions.push_back({static_cast<std::uint32_t>(random.below(256)), static_cast<std::uint32_t>(random.below(256)),
                           static_cast<std::uint32_t>(random.below(256))});
      values.push_back(static_cast<std::int32_t>(positions.back()[0] + random.below(noise)));
    }
    const UvFit fit = fit_uv(values, positions, true);
    if (fit.has_slope) {
      EXPECT_LT(fit.range.bits, plain_bits(values)) << "seed 43, round " << round;
    } else {
      EXPECT_EQ(fit.range.bits, plain_bits(values)) << "seed 43, round " << round;
    }
    ++(fit.has_slope ? sloped : plain);
  }
  EXPECT_GT(sloped, 200);
  EXPECT_GT(plain, 200);
}

// By one coordinate alone, the others being what they are: no slope of theirs is needed for this one's.
TEST(Fits, AMapOfOneCoordinateLosesItsRange) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<RawPosition> positions;
    std::vector<std::int32_t> values;
    for (std::uint32_t i = 0; i < 64; ++i) {
      RawPosition p{};
      p[axis] = 16 * i;
      positions.push_back(p);
      values.push_back(static_cast<std::int32_t>(3 * 16 * i));
    }
    const UvFit fit = fit_uv(values, positions, true);
    expect_undone(values, positions, fit);
    EXPECT_TRUE(fit.has_slope);
    EXPECT_EQ(fit.range.bits, 0U) << axis;
  }
}

// Coefficients have ten bits with the sign: 510.5 / 512 is kept as 511 / 2^9, and twice as fine would not fit.
TEST(Fits, SlopesAreKeptAsFineAsTenBitsHold) {
  std::vector<RawPosition> positions;
  std::vector<std::int32_t> values;
  for (std::uint32_t i = 0; i < 4; ++i) {
    positions.push_back({i % 2 * 1024, i / 2 * 1024, 0});
    values.push_back(static_cast<std::int32_t>(i % 2 * 1021 + i / 2 * 6));
  }
  const UvFit fit = fit_uv(values, positions, true);
  expect_undone(values, positions, fit);
  ASSERT_TRUE(fit.has_slope);
  EXPECT_EQ(fit.shift, 9U);
  EXPECT_EQ(fit.slope, (std::array<std::int32_t, 3>{511, 3, 0}));
}

TEST(Fits, AnyCoordinatesComeBack) {
  test::Random random(41);
  for (int round = 0; round < 400; ++round) {
    const auto count = 1 + random.below(256);
    const auto value_size = 1 + random.below(std::uint64_t{1} << random.below(25));
    std::array<std::uint64_t, 3> size{};
    for (std::uint64_t& s : size) s = 1 + random.below(std::uint64_t{1} << random.below(25));
    std::vector<RawPosition> positions;
    std::vector<std::int32_t> values;
    for (std::uint64_t i = 0; i < count; ++i) {
      RawPosition p{};
      for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<std::uint32_t>(random.below(size[k]));
      positions.push_back(p);
      auto value = static_cast<std::int32_t>(random.below(value_size)) - static_cast<std::int32_t>(value_size / 2);
      // A slope far above what a coefficient holds, and one that products wrap with.
      if (round % 4 == 0) value = std::clamp(static_cast<std::int32_t>(p[0] % 10000) * 900, -16777215, 16777215);
      values.push_back(value);
    }
    expect_undone(values, positions, fit_uv(values, positions, true));
  }
}

// The slopes that the positions were made with, to the nearest, leave no fewer bits, whichever way they lean.
TEST(Fits, TheShearThatWasMadeIsNoShorter) {
  test::Random random(47);
  int sheared = 0;
  for (int round = 0; round < 400; ++round) {
    const std::size_t axis = static_cast<std::size_t>(round) % 3, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const double scale = 1 << format::kShearShift;
    const double su = 1.9 * random.signed_unit(), sv = 1.9 * random.signed_unit();
    std::vector<Position> positions;
    for (int i = 0; i < 40; ++i) {
      Position p{};
      p[u] = static_cast<std::int32_t>(random.below(5000));
      p[v] = static_cast<std::int32_t>(random.below(5000));
      p[axis] = static_cast<std::int32_t>(std::floor(su * p[u] + sv * p[v] + 6.0 * random.unit()));
      positions.push_back(p);
    }
    const PositionFit fit = fit_positions(positions);
    expect_undone(positions, fit);
    const std::uint32_t bits = fit.range[0].bits + fit.range[1].bits + fit.range[2].bits;
    sheared += fit.axis == axis ? 1 : 0;
    std::array<std::int32_t, 3> least = positions[0];
    for (const Position& p : positions) {
      for (std::size_t k = 0; k < 3; ++k) least[k] = std::min(least[k], p[k]);
    }
    const auto tu = static_cast<std::int32_t>(std::floor(su * scale + 0.5));
    const auto tv = static_cast<std::int32_t>(std::floor(sv * scale + 0.5));
    if (std::abs(tu) > 126 || std::abs(tv) > 126) continue;
    std::vector<std::int32_t> rest, of_u, of_v;
    for (const Position& p : positions) {
      rest.push_back(p[axis] - ((tu * (p[u] - least[u]) + tv * (p[v] - least[v])) >> format::kShearShift));
      of_u.push_back(p[u]);
      of_v.push_back(p[v]);
    }
    EXPECT_LE(bits, range_of(rest).bits + range_of(of_u).bits + range_of(of_v).bits) << "seed 47, round " << round;
  }
  EXPECT_GT(sheared, 50);
}

// Coefficients are rounded to the nearest, whichever sign they have and whichever axis they are of.
TEST(Fits, NegativeSlopesAreKeptAsFineAsPositiveOnes) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::int32_t sign : {1, -1}) {
      for (const std::int32_t rise : {1021, 1023, 777, 300}) {
        std::vector<RawPosition> positions;
        std::vector<std::int32_t> values;
        for (std::uint32_t i = 0; i < 8; ++i) {
          RawPosition p{};
          p[axis] = i * 1024;
          positions.push_back(p);
          values.push_back(sign * static_cast<std::int32_t>(i) * rise);
        }
        const UvFit fit = fit_uv(values, positions, true);
        expect_undone(values, positions, fit);
        ASSERT_TRUE(fit.has_slope);
        const double exact = sign * rise / 1024.0 * std::ldexp(1.0, static_cast<int>(fit.shift));
        EXPECT_EQ(fit.slope[axis], static_cast<std::int32_t>(std::floor(exact + 0.5))) << axis << ", " << sign * rise;
        EXPECT_LE(std::abs(exact), 511.0);
        EXPECT_GT(2.0 * std::abs(exact) + 0.5, 511.0) << "as fine as ten bits hold";
      }
    }
  }
}

TEST(Fits, SlopesUpToTheLimitAreKept) {
  for (const std::int32_t slope : {511, -511}) {
    std::vector<RawPosition> positions;
    std::vector<std::int32_t> values;
    for (std::uint32_t i = 0; i < 8; ++i) {
      positions.push_back({i, 0, 0});
      values.push_back(slope * static_cast<std::int32_t>(i));
    }
    const UvFit fit = fit_uv(values, positions, true);
    EXPECT_TRUE(fit.has_slope);
    EXPECT_EQ(fit.range.bits, 0U);
  }
}

// Beside ranges of up to 22 bits an axis is sheared, beside wider ones its products would not fit.
TEST(Fits, PlanesOfUpToTwentyTwoBitsLoseAnAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::int32_t side : {(1 << 22) - 1, 1 << 22}) {
      std::vector<Position> positions;
      for (int i = 0; i < 16; ++i) {
        Position p{};
        const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        p[u] = i % 2 * side;
        p[v] = i / 2 % 2 * side;
        p[axis] = p[u] / 64 * 32 + p[v] / 64 * 16;  // slopes of 1/2 and 1/4
        positions.push_back(p);
      }
      const PositionFit fit = fit_positions(positions);
      expect_undone(positions, fit);
      EXPECT_EQ(fit.axis == axis && fit.range[axis].bits < 7, side < (1 << 22)) << axis << ", " << side;
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
