// SPDX-License-Identifier: GPL-3.0-or-later
// Which points of the source are held against a DAG, and which are carried on.
#include "builder/promise/source_points.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "builder/lod_dag.h"
#include "builder/promise/painted_source.h"

namespace meshlode::builder {
namespace {

/// A strip of squares in the plane; the texture is the place.
ProductSurface<5> strip5(std::uint32_t squares) {
  ProductSurface<5> out;
  for (std::uint32_t i = 0; i <= squares; ++i) {
    for (const double y : {0.0, 1.0}) out.points.push_back({1.0 * i, y, 0.0, 1.0 * i, y});
  }
  for (std::uint32_t i = 0; i < squares; ++i) {
    out.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    out.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  return out;
}

struct FivePoints {
  ProductSurface<5> source;
  ProductSpace space;
  LodDag dag;
  format::MeshRecord record{};
  ProductSurfaces<5> surfaces{space, dag, record};
  SourcePoints<5> points{surfaces, source};

  explicit FivePoints(std::uint32_t squares) : source(strip5(squares)) {}
};

TEST(SourcePoints, AreEachVertexEachMiddleAndManyBetween) {
  const FivePoints five(50);
  const std::vector<SourcePoint> all = five.points.choose();
  std::size_t vertices = 0, middles = 0;
  for (const SourcePoint& point : all) {
    vertices += point.is_vertex() ? 1 : 0;
    middles += point.b == 1.0F / 3.0F && point.c == 1.0F / 3.0F ? 1 : 0;
  }
  EXPECT_EQ(vertices, five.source.points.size());
  EXPECT_EQ(middles, five.source.triangles.size());
  EXPECT_NEAR(static_cast<double>(all.size()), 100000.0, 1000.0) << "however few triangles there are";
}

TEST(SourcePoints, TheFarthestAndSomeOfAllOthersAreCarriedOn) {
  const FivePoints five(50);
  SplitMix64 random(71);
  std::vector<SourcePoint> samples;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const auto [b, c] = random_weights(random);
    samples.push_back({i % 100, static_cast<float>(b), static_cast<float>(c), static_cast<float>(random.unit()), 0});
  }
  const std::vector<SourcePoint> before = samples;
  const std::vector<SourcePoint> kept = five.points.thin(samples, 512);
  // Of one place of 512: the 64 farthest, half as many of the rest, and the outermost of five coordinates.
  ASSERT_GE(kept.size(), 96U);
  ASSERT_LE(kept.size(), 96U + 10U);
  std::vector<float> distances;
  for (const SourcePoint& point : before) distances.push_back(point.distance);
  std::sort(distances.rbegin(), distances.rend());
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(kept[i].distance, distances[i]);
  EXPECT_LT(kept[95].distance, distances[2000]) << "from all over the rest";
  const auto range_of = [&](const std::vector<SourcePoint>& some, std::size_t d) {
    const auto at = [&](const SourcePoint& point) { return five.source.at(point.triangle, point.b, point.c)[d]; };
    const auto [least, most] = std::minmax_element(
        some.begin(), some.end(), [&](const SourcePoint& x, const SourcePoint& y) { return at(x) < at(y); });
    return std::pair(at(*least), at(*most));
  };
  for (std::size_t d = 0; d < 5; ++d) EXPECT_EQ(range_of(kept, d), range_of(before, d)) << d;
}

}  // namespace
}  // namespace meshlode::builder
