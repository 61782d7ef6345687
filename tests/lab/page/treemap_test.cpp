// SPDX-License-Identifier: GPL-3.0-or-later
#include "lab/page/treemap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "lab/page/well_formed.h"
#include "support/random.h"

namespace meshlode::lab::page {
namespace {

/// The area that two boxes share.
double overlap(const Box& a, const Box& b) {
  const double width = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x);
  const double height = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return std::max(width, 0.0) * std::max(height, 0.0);
}

TEST(Treemap, IsThatOfThePaper) {
  // Bruls, Huizing and van Wijk's example: 6, 6, 4, 3, 2, 2, 1 in a room of 6 x 4.
  const std::vector<double> sizes = {6, 6, 4, 3, 2, 2, 1};
  const std::vector<Box> boxes = squarify(sizes, {0, 0, 6, 4});
  ASSERT_EQ(boxes.size(), sizes.size());
  const auto expect_box = [&](std::size_t i, double x, double y, double width, double height) {
    EXPECT_NEAR(boxes[i].x, x, 1e-12) << i;
    EXPECT_NEAR(boxes[i].y, y, 1e-12) << i;
    EXPECT_NEAR(boxes[i].width, width, 1e-12) << i;
    EXPECT_NEAR(boxes[i].height, height, 1e-12) << i;
  };
  expect_box(0, 0, 0, 3, 2);
  expect_box(1, 0, 2, 3, 2);
  expect_box(2, 3, 0, 12.0 / 7.0, 7.0 / 3.0);
  expect_box(3, 3 + 12.0 / 7.0, 0, 9.0 / 7.0, 7.0 / 3.0);
}

TEST(Treemap, FillsTheRoomInProportionWithoutOverlap) {
  test::Random random(11);
  for (int run = 0; run < 300; ++run) {
    std::vector<double> sizes(1 + static_cast<std::size_t>(random.between(0.0, 40.0)));
    for (double& size : sizes) size = std::exp(random.between(-6.0, 6.0));
    if (run % 2 == 0) std::sort(sizes.rbegin(), sizes.rend());
    const Box room{5.0, -3.0, random.between(1.0, 900.0), random.between(1.0, 900.0)};
    double total = 0.0, area = 0.0;
    for (const double size : sizes) total += size;
    const std::vector<Box> boxes = squarify(sizes, room);
    ASSERT_EQ(boxes.size(), sizes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      ASSERT_NEAR(boxes[i].area() / room.area(), sizes[i] / total, 1e-9);
      ASSERT_NEAR(overlap(boxes[i], room), boxes[i].area(), 1e-9 * room.area()) << "outside the room";
      for (std::size_t k = 0; k < i; ++k) ASSERT_LE(overlap(boxes[i], boxes[k]), 1e-9 * room.area());
      area += boxes[i].area();
    }
    ASSERT_NEAR(area, room.area(), 1e-9 * room.area());
  }
}

TEST(Treemap, GivesNothingToNothing) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> sizes = {0.0, 1.0, -2.0, infinity, std::numeric_limits<double>::quiet_NaN()};
  const std::vector<Box> boxes = squarify(sizes, {0, 0, 10, 10});
  EXPECT_NEAR(boxes[1].area(), 100.0, 1e-9);
  for (const std::size_t i : {0U, 2U, 3U, 4U}) EXPECT_EQ(boxes[i].area(), 0.0);
  EXPECT_TRUE(squarify({}, {0, 0, 10, 10}).empty());
  EXPECT_EQ(squarify(sizes, {0, 0, 0, 10})[1].area(), 0.0);
}

TEST(Treemap, DrawnHasEveryPartThatHasBytes) {
  const Treemap map{"t", "A map", "of <bytes>", {{"small", 10}, {"none", 0}, {"<large>", 1000}}};
  for (const Standing standing : {Standing::kInPage, Standing::kAlone}) {
    const std::string svg = draw_treemap(map, standing);
    EXPECT_EQ(find_fault(svg), "");
    EXPECT_NE(svg.find("<title>&lt;large&gt;: 1 kB</title>"), std::string::npos) << svg;
    EXPECT_NE(svg.find("<title>small: 10 B</title>"), std::string::npos);
    EXPECT_EQ(svg.find("none:"), std::string::npos);
    EXPECT_LT(svg.find("large"), svg.find("small: "));
  }
}

}  // namespace
}  // namespace meshlode::lab::page
