// SPDX-License-Identifier: GPL-3.0-or-later
// What a collapse leaves behind, against every point and every triangle: of random triangles around an edge, so that
// sheets, ears, bridges and whole pieces go.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/left_behind.h"
#include "builder/simplify/point_triangle.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::DrawnMesh;
using test::random_point;
using test::RandomSource;

struct LeftAt {
  double uncovered2 = 0.0;  ///< of what goes without a vertex noticing
  double witnesses2 = 0.0;  ///< to the new star
  double rest2 = 0.0;       ///< to what stays elsewhere
  std::vector<std::uint32_t> vanishing;
};

bool has_end(const WedgeTriangle& t) {
  return std::any_of(t.begin(), t.end(), [](std::uint32_t v) { return v < 2; });
}

LeftAt left_at(const DrawnMesh& drawn, const CollapseStar& star, const std::vector<Witnesses>& witnesses) {
  LeftAt left;
  const auto& places = drawn.places;
  std::vector<std::uint8_t> stays(drawn.points.size(), 0), is_beside(drawn.points.size(), 0), has_other = stays;
  for (const CollapseStar::OuterEdge& edge : star.outer()) stays[edge.x] = stays[edge.y] = 1;
  for (std::uint32_t t = 0; t < drawn.triangles.size(); ++t) {
    if (!drawn.mesh.is_alive(t)) continue;
    for (const std::uint32_t v : drawn.triangles[t]) (has_end(drawn.triangles[t]) ? is_beside : has_other)[v] = 1;
  }
  for (std::uint32_t v = 2; v < drawn.points.size(); ++v) {
    if (is_beside[v] == 0 || stays[v] != 0) continue;
    // The edge to it goes: its middle is left, or all of it where nothing else holds the vertex.
    const double length = glm::length(places[v] - star.target);
    const double off = has_other[v] != 0 ? 0.5 * length : length;
    left.uncovered2 = std::max(left.uncovered2, off * off);
    if (has_other[v] == 0) left.vanishing.push_back(v);
  }
  for (std::size_t k = 0; k < star.sheets().size(); k += 2) {  // half its height over the edge that stays
    const WedgeTriangle& t = drawn.triangles[star.sheets()[k]];
    const std::size_t end = t[0] < 2 ? 0 : t[1] < 2 ? 1 : 2;
    const Vec3d x = places[t[(end + 1) % 3]], along = places[t[(end + 2) % 3]] - x;
    const double length = glm::length(along);
    if (!(length > 0.0)) continue;
    const double height = glm::length(glm::cross(along, star.target - x)) / length;
    left.uncovered2 = std::max(left.uncovered2, 0.25 * height * height);
  }
  std::vector<std::uint32_t> of{0, 1};
  of.insert(of.end(), left.vanishing.begin(), left.vanishing.end());
  for (const std::uint32_t v : of) {
    for (std::uint32_t i = 0; i < witnesses[v].count; ++i) {
      const Vec3d p = places.to_frame(witnesses[v].points[i]);
      double to_star = std::numeric_limits<double>::infinity(), to_rest = to_star;
      for (const CollapseStar::OuterEdge& edge : star.outer())
        to_star = std::min(to_star, distance2_to_facet(p, star.target, places[edge.x], places[edge.y]));
      for (std::uint32_t t = 0; t < drawn.triangles.size(); ++t) {
        const WedgeTriangle& v3 = drawn.triangles[t];
        if (drawn.mesh.is_alive(t) && !has_end(v3))
          to_rest = std::min(to_rest, distance2_to_facet(p, places[v3[0]], places[v3[1]], places[v3[2]]));
      }
      left.witnesses2 = std::max(left.witnesses2, to_star);
      left.rest2 = std::max(left.rest2, to_rest);
    }
  }
  return left;
}

double weigh(LeftBehind& left, DrawnMesh& drawn, const CollapseStar& star, bool keep_area) {
  const std::optional<float> left2 = left.weigh(drawn.mesh, drawn.places, drawn.marks, star, {false, false, keep_area});
  EXPECT_TRUE(left2.has_value());
  return double{left2.value_or(-1.0F)};
}

TEST(LeftBehindOracle, IsTheFarthestOfEverythingThatGoes) {
  RandomSource random(191);
  int vanished = 0, with_sheets = 0, with_vanishing = 0;
  for (int round = 0; round < 2000; ++round) {
    const std::uint32_t count = 5 + random.below(8);
    std::vector<Vec3i> points;
    for (std::uint32_t v = 0; v < count; ++v) points.push_back(random_point(random, 1000));
    std::vector<WedgeTriangle> triangles;
    const bool is_piece = round % 4 == 0;  // nothing around the edge but triangles on it
    const auto other = [&] { return 2 + random.below(count - 2); };
    for (std::uint32_t n = 1 + random.below(3); n > 0; --n) triangles.push_back({0, 1, other()});
    for (std::uint32_t n = is_piece ? 0 : 1 + random.below(5); n > 0; --n) {
      const std::uint32_t x = other(), y = other(), end = random.below(2);
      if (x == y) continue;
      triangles.push_back({end, x, y});
      if (random.chance(0.4)) triangles.push_back({1 - end, y, x});
    }
    for (std::uint32_t n = random.below(4); n > 0; --n) {
      const std::uint32_t x = other(), y = other(), z = other();
      if (x != y && y != z && z != x) triangles.push_back({x, y, z});
    }
    for (std::size_t i = triangles.size(); i > 1; --i)
      std::swap(triangles[i - 1], triangles[random.below(static_cast<std::uint32_t>(i))]);
    DrawnMesh drawn(points, triangles);
    std::vector<Witnesses> witnesses(count);
    for (Witnesses& w : witnesses) {
      w.count = random.below(4);
      for (Vec3i& point : w.points) point = random_point(random, 1400) - Vec3i(200);
    }
    const CollapseStar star = drawn.star_at(drawn.places.to_frame(random_point(random, 1000)), 0, 1, round % 2 == 0);
    const LeftAt expected = left_at(drawn, star, witnesses);
    LeftBehind left(witnesses, drawn.points);
    const double of_star = std::max(expected.uncovered2, expected.witnesses2);
    if (!star.outer().empty()) {
      for (const bool keeps_area : {false, true}) {
        EXPECT_NEAR(weigh(left, drawn, star, keeps_area), of_star, test::kFloats * (1.0 + of_star))
            << "seed 191, round " << round;
      }
    } else {
      ++vanished;
      const double rest = std::max(expected.uncovered2, std::min(expected.rest2, 1e30));
      EXPECT_NEAR(weigh(left, drawn, star, false), rest, test::kFloats * (1.0 + rest)) << "seed 191, round " << round;
      const Vec3d low = glm::min(drawn.places[0], drawn.places[1]), high = glm::max(drawn.places[0], drawn.places[1]);
      const double size2 = std::max(expected.uncovered2, glm::dot(high - low, high - low));
      EXPECT_NEAR(weigh(left, drawn, star, true), size2, test::kFloats * (1.0 + size2)) << "seed 191, round " << round;
    }
    with_sheets += star.sheets().empty() ? 0 : 1;
    with_vanishing += expected.vanishing.empty() ? 0 : 1;
    // The joined vertex stands for the box of both. (Of a piece of foliage that goes no witness is carried on.)
    (void)weigh(left, drawn, star, false);
    left.join(0, 1);
    const Vec3d apart = drawn.places[0] - drawn.places[1];
    EXPECT_NEAR(left.size2(0, drawn.places), glm::dot(apart, apart), 1e-12);
    EXPECT_EQ(left.size2(2, drawn.places), 0.0);
    std::uint32_t weighed = witnesses[0].count + witnesses[1].count;
    for (const std::uint32_t v : expected.vanishing) weighed += witnesses[v].count;
    EXPECT_EQ(left.witnesses(0).count, std::min<std::uint32_t>(weighed, Witnesses::kCapacity));
  }
  EXPECT_GT(vanished, 200);
  EXPECT_GT(with_sheets, 100);
  EXPECT_GT(with_vanishing, 200);
}

// The farthest stay, equals in the order they came.
TEST(LeftBehindOracle, OfManyWitnessesTheFarthestStayInOrder) {
  for (const std::uint32_t ears : {2U, 5U, 8U}) {
    // Ears on the edge (0, 1), each with three witnesses of its own; one triangle keeps the star from being empty.
    std::vector<Vec3i> points{{0, 0, 0}, {100, 0, 0}, {0, 100, 0}, {100, 100, 0}};
    std::vector<WedgeTriangle> triangles{{1, 3, 2}};
    std::vector<Witnesses> witnesses(4 + ears);
    std::vector<std::pair<int, std::uint32_t>> heights;  // negative, and the number: in order
    std::uint32_t id = 0;
    for (std::uint32_t e = 0; e < ears; ++e) {
      points.push_back({static_cast<int>(e), -60, 0});
      triangles.push_back({0, 1, 4 + e});
      for (std::uint32_t k = 0; k < 3; ++k) {
        const int height = 40 + static_cast<int>((7 * id) % 50);
        witnesses[4 + e].points[k] = {70, 70, height};  // over the triangle that stays
        witnesses[4 + e].ids[k] = id;
        witnesses[4 + e].count = 3;
        heights.emplace_back(-height, id++);
      }
    }
    DrawnMesh drawn(points, triangles);
    LeftBehind left(witnesses, drawn.points);
    const CollapseStar star = drawn.star_at(drawn.places.to_frame({100, 0, 0}), 0, 1);
    ASSERT_FALSE(star.outer().empty());
    ASSERT_GE(weigh(left, drawn, star, false), 0.0);
    left.join(0, 1);
    std::stable_sort(heights.begin(), heights.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < Witnesses::kCapacity; ++i)
      EXPECT_EQ(left.witnesses(0).ids[i], heights[i].second) << ears << " ears, witness " << i;
  }
}

// The smallest height of a sheet that is dropped, whatever its shape.
TEST(LeftBehindOracle, ASheetIsAsHighAsItsSmallestHeight) {
  RandomSource random(192);
  for (int round = 0; round < 500; ++round) {
    std::vector<Vec3i> points;
    for (int v = 0; v < 4; ++v) points.push_back(random_point(random, 1000));
    if (round % 10 == 0) points[2] = points[1];
    DrawnMesh drawn(points, {{0, 1, 2}, {2, 1, 0}, {0, 1, 3}, {1, 2, 3}});
    const auto place = [&](std::uint32_t v) { return drawn.places[v]; };
    const double longest = std::max(
        {glm::length(place(1) - place(0)), glm::length(place(2) - place(1)), glm::length(place(0) - place(2))});
    const double height =
        longest > 0.0 ? glm::length(glm::cross(place(1) - place(0), place(2) - place(0))) / longest : 0.0;
    const CollapseStar star = drawn.star_at(place(0), 0, 3);
    EXPECT_NEAR(std::sqrt(height2_of_sheet(drawn.mesh, drawn.places, star, 0, true)), height, 1e-12)
        << "seed 192, round " << round;
    const double base = glm::length(place(2) - place(1));
    const double above = base > 0.0 ? height * longest / base : 0.0;
    EXPECT_NEAR(std::sqrt(height2_of_sheet(drawn.mesh, drawn.places, star, 1, false)), above, 1e-9 * (1.0 + above))
        << "seed 192, round " << round;
  }
}

// A sheet of a few units in a group of millions is a sheet.
TEST(LeftBehindOracle, TinySheetsHaveAHeight) {
  const int most = 1 << 22;
  DrawnMesh drawn({{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {-most, 0, 0}, {most, 0, 1}},
                  {{0, 1, 2}, {2, 1, 0}, {0, 1, 3}, {1, 2, 4}});
  const CollapseStar star = drawn.star_at(drawn.places[0], 0, 3);
  const double height2 = height2_of_sheet(drawn.mesh, drawn.places, star, 0, true);
  EXPECT_NEAR(std::sqrt(height2) * drawn.places.scale(), 12.0 / 5.0, 1e-9);
}

}  // namespace
}  // namespace meshlode::builder
