// SPDX-License-Identifier: GPL-3.0-or-later
// What has area, decided exactly: against integers, and builder against judge, which share no line of code.
#include "builder/prepare/zero_area.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "judge/metrics/drawn_triangles.h"
#include "judge/metrics/triangle_area.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::Random;

void expect_collinear(const Vec3d& a, const Vec3d& b, const Vec3d& c, bool expected) {
  for (const auto& [p, q, r] : {std::array{a, b, c}, std::array{c, a, b}, std::array{b, a, c}}) {
    EXPECT_EQ(are_collinear(p, q, r), expected) << "builder";
    EXPECT_EQ(!judge::has_area(p, q, r), expected) << "judge";
  }
}

TEST(ZeroArea, OneBitDecides) {
  expect_collinear({0, 0, 0}, {1, 1, 1}, {3, 3, 3}, true);
  expect_collinear({0, 0, 0}, {1, 1, 1}, {3, 3, std::nextafter(3.0, 4.0)}, false);
  expect_collinear({0.1, 0.1, 0.1}, {0.2, 0.2, 0.2}, {0.7, 0.7, 0.7}, true);
  expect_collinear({0.1, 0.2, 0}, {0.2, 0.4, 0}, {0.4, 0.8, 0}, true);
  expect_collinear({0.1, 0.1, 0}, {0.2, 0.2, 0}, {0.3, 0.1 + 0.2, 0}, false);
}

TEST(ZeroArea, AnyFiniteDoubleWillDo) {
  const double tiny = std::numeric_limits<double>::denorm_min(), huge = std::numeric_limits<double>::max();
  expect_collinear({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, false);
  expect_collinear({0, 0, 0}, {tiny, tiny, 0}, {3 * tiny, 3 * tiny, 0}, true);
  expect_collinear({-huge, -huge, 0}, {huge, huge, 0}, {0, 0, 0}, true);
  expect_collinear({-huge, -huge, 0}, {huge, huge, 0}, {0, tiny, 0}, false);
  expect_collinear({1, 1, 1}, {1, 1, 1}, {2, 3, 4}, true);
  expect_collinear({huge, tiny, 1}, {huge, tiny, 1}, {huge, tiny, 1}, true);
}

TEST(ZeroArea, AgreesWithIntegers) {
  Random random(31);
  int lines = 0;
  for (int round = 0; round < 20000; ++round) {
    std::array<std::array<std::int64_t, 3>, 3> p{};
    // Few values, so that many are on a line; 2^26 of them, so that products fill 53 bits and more.
    const std::uint64_t range = round % 2 == 0 ? 3 : 1ULL << 26U;
    for (auto& corner : p) {
      for (auto& x : corner) x = static_cast<std::int64_t>(random.below(range));
    }
    const auto factor = static_cast<std::int64_t>(random.below(5));
    if (round % 4 == 1) {
      for (std::size_t k = 0; k < 3; ++k) p[2][k] = p[0][k] + factor * (p[1][k] - p[0][k]);
    }
    if (round % 8 == 1) p[2][random.below(3)] += 1;
    bool is_line = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
      is_line = is_line && (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) == (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
    }
    lines += is_line ? 1 : 0;
    const double unit = std::ldexp(1.0, static_cast<int>(random.below(200)) - 100);
    const auto at = [&](std::size_t i) {
      return Vec3d(static_cast<double>(p[i][0]), static_cast<double>(p[i][1]), static_cast<double>(p[i][2])) * unit;
    };
    ASSERT_EQ(are_collinear(at(0), at(1), at(2)), is_line) << "round " << round;
    ASSERT_EQ(judge::has_area(at(0), at(1), at(2)), !is_line) << "round " << round;
  }
  EXPECT_GT(lines, 2000);
  EXPECT_LT(lines, 18000);
}

struct Shape {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> triangles;

  std::vector<std::uint8_t> undrawn() const { return find_undrawn(positions, triangles); }
  std::vector<std::uint8_t> drawn() const {
    std::vector<std::array<Vec3d, 3>> corners;
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
      corners.push_back({positions[triangles[i]], positions[triangles[i + 1]], positions[triangles[i + 2]]});
    }
    return judge::find_drawn(corners);
  }
  void expect_drawn(const std::vector<std::uint8_t>& expected) const {
    EXPECT_EQ(drawn(), expected) << "judge";
    std::vector<std::uint8_t> kept = undrawn();
    for (std::uint8_t& is_kept : kept) is_kept = is_kept == 0 ? 1 : 0;
    EXPECT_EQ(kept, expected) << "builder";
  }
};

TEST(ZeroArea, WhatLiesAlongAnEdgeStays) {
  // 0 … 4 on the x axis, 5 off it. 6 is where 1 is.
  const std::vector<Vec3d> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  Shape{line, {0, 4, 5, 0, 2, 4}}.expect_drawn({1, 1});
  Shape{line, {0, 4, 5, 0, 2, 4, 2, 3, 4, 2, 3, 1}}.expect_drawn({1, 1, 1, 0});
  Shape{line, {0, 4, 5, 0, 3, 4, 0, 2, 3, 0, 6, 2}}.expect_drawn({1, 1, 1, 1});
  // Both short edges are covered, and so the long one, and what lies along it.
  Shape{line, {0, 2, 5, 2, 4, 5, 4, 2, 0, 0, 1, 4}}.expect_drawn({1, 1, 1, 1});
  // One short edge alone: the other end sticks out.
  Shape{line, {0, 2, 5, 0, 2, 4, 0, 4, 2}}.expect_drawn({1, 0, 0});
  // Nothing with area, and corners in one place.
  Shape{line, {0, 1, 2, 2, 1, 0, 1, 6, 5}}.expect_drawn({0, 0, 0});
}

TEST(ZeroArea, BuilderAndJudgeAgreeOnLongChainsAndSoups) {
  Random random(32);
  for (int round = 0; round < 60; ++round) {
    Shape shape;
    const std::uint64_t side = 2 + random.below(6);
    for (int i = 0; i < 60; ++i) {
      shape.positions.emplace_back(static_cast<double>(random.below(side)), static_cast<double>(random.below(side)),
                                   round % 3 == 0 ? 0.0 : static_cast<double>(random.below(2)));
    }
    for (int i = 0; i < 3 * 200; ++i) shape.triangles.push_back(static_cast<std::uint32_t>(random.below(60)));
    const std::vector<std::uint8_t> drawn = shape.drawn();
    shape.expect_drawn(drawn);
  }
  // Each triangle is covered by the one before: as long as the list, in the worst order for sweeps.
  Shape chain{{{0, 1, 0}, {0, 0, 0}}, {}};
  constexpr std::uint32_t kCount = 20000;
  for (std::uint32_t i = 0; i <= kCount; ++i) chain.positions.emplace_back(static_cast<double>(i + 1), 0.0, 0.0);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    for (const std::uint32_t v : {1U, i + 2, i + 3}) chain.triangles.push_back(v);
  }
  for (const std::uint32_t v : {1U, kCount + 2, 0U}) chain.triangles.push_back(v);
  chain.expect_drawn(std::vector<std::uint8_t>(kCount + 1, 1));
}

}  // namespace
}  // namespace meshlode::builder
