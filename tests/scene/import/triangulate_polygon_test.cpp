// SPDX-License-Identifier: GPL-3.0-or-later
// Polygons that no fan covers: areas by the shoelace formula, corners of bridges, and what crosses itself.
#include "scene/import/polygons/triangulate_polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "scene/import/polygons/face_triangles.h"

namespace meshlode::scene {
namespace {

using Points = std::vector<std::array<double, 2>>;

double shoelace(const Points& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto& [x, y] = p[i];
    const auto& [u, v] = p[(i + 1) % p.size()];
    sum += x * v - u * y;
  }
  return sum / 2.0;
}

/// The sum over the triangles, none of which may be turned over.
double covered(const Points& p, const PolygonTriangles& made) {
  double sum = 0.0;
  for (const auto& [a, b, c] : made.triangles) {
    const double twice = (p[b][0] - p[a][0]) * (p[c][1] - p[a][1]) - (p[c][0] - p[a][0]) * (p[b][1] - p[a][1]);
    EXPECT_GT(twice, 0.0);
    sum += twice / 2.0;
  }
  return sum;
}

const Points kFrame{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
const Points kComb{{0, 0}, {5, 0}, {5, 2}, {4, 2}, {4, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

TEST(TriangulatePolygon, DentedAndBridgedPolygonsAreCoveredOnce) {
  const Points u{{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}};
  for (const Points& points : {kFrame, kComb, u}) {
    const auto made = triangulate_polygon(points);
    EXPECT_TRUE(made.is_simple);
    EXPECT_EQ(made.triangles.size(), points.size() - 2);
    EXPECT_DOUBLE_EQ(covered(points, made), shoelace(points));
  }
}

TEST(TriangulatePolygon, EachEndOfABridgeIsTheCornerOfItsSide) {
  // Corners 0 and 4 are one point, 5 and 9 too: what lies below the bridge has 0 and 9, above it 4 and 5.
  const auto made = triangulate_polygon(kFrame);
  for (const auto& t : made.triangles) {
    const std::set<std::uint32_t> corners(t.begin(), t.end());
    const bool is_below = corners.contains(0) || corners.contains(9) || corners.contains(8) || corners.contains(1);
    const bool is_above = corners.contains(4) || corners.contains(5) || corners.contains(3) || corners.contains(6);
    EXPECT_FALSE(is_below && is_above && !corners.contains(2) && !corners.contains(7)) << t[0] << t[1] << t[2];
    EXPECT_FALSE(corners.contains(0) && corners.contains(4));
    EXPECT_FALSE(corners.contains(0) && corners.contains(5));
    EXPECT_FALSE(corners.contains(4) && corners.contains(9));
  }
}

TEST(TriangulatePolygon, TheNumberingDoesNotDecideWhereTheDiagonalsAre) {
  for (const Points& points : {kFrame, kComb}) {
    std::set<std::set<std::array<double, 2>>> first;
    for (std::size_t turn = 0; turn < points.size(); ++turn) {
      Points turned;
      for (std::size_t i = 0; i < points.size(); ++i) turned.push_back(points[(i + turn) % points.size()]);
      std::set<std::set<std::array<double, 2>>> places;
      for (const auto& t : triangulate_polygon(turned).triangles)
        places.insert({turned[t[0]], turned[t[1]], turned[t[2]]});
      if (turn == 0) first = places;
      EXPECT_EQ(places, first);
    }
  }
}

TEST(TriangulatePolygon, CornersOnASideAndRepeatedOnesAreNoCrossing) {
  const Points on_side{{0, 0}, {2, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}};  // touches its own lower side
  EXPECT_DOUBLE_EQ(covered(on_side, triangulate_polygon(on_side)), shoelace(on_side));
  const Points repeated{{0, 0}, {0, 0}, {2, 0}, {1, 0.5}, {2, 2}, {2, 2}, {0, 2}};
  EXPECT_DOUBLE_EQ(covered(repeated, triangulate_polygon(repeated)), shoelace(repeated));
}

TEST(TriangulatePolygon, WhatCrossesItselfIsSaidSo) {
  EXPECT_TRUE(triangulate_polygon(Points{{0, 0}, {2, 2}, {2, 0}, {0, 2.5}}).triangles.empty());
  EXPECT_TRUE(triangulate_polygon(Points{{0, 0}, {1, 0}, {2, 0}}).triangles.empty());
  // A hole that turns the same way as the border: what lies inside both is outside.
  const Points same{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {3, 1}, {3, 3}, {1, 3}, {1, 1}};
  const auto made = triangulate_polygon(same);
  EXPECT_FALSE(made.is_simple);
  EXPECT_DOUBLE_EQ(covered(same, made), 12.0);
}

TEST(TriangulatePolygon, StarsOfRandomRadiiAreCoveredExactly) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    const std::size_t n = 5 + random() % 60;
    Points points;
    for (std::size_t k = 0; k < n; ++k) {
      const double angle = 6.283185307179586 * static_cast<double>(k) / static_cast<double>(n);
      const double radius = 0.05 + static_cast<double>(random() % 1000) / 1000.0;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    const auto made = triangulate_polygon(points);
    EXPECT_EQ(made.triangles.size(), n - 2);
    EXPECT_NEAR(covered(points, made), shoelace(points), 1e-12);
  }
}

TEST(TriangulatePolygon, AnyPointsAtAllEnd) {
  std::mt19937 random(11);
  for (int i = 0; i < 2000; ++i) {
    Points points(3 + random() % 14);
    for (auto& [x, y] : points) x = static_cast<double>(random() % 4), y = static_cast<double>(random() % 4);
    for (const auto& t : triangulate_polygon(points).triangles) {
      for (const std::uint32_t corner : t) EXPECT_LT(corner, points.size());
    }
  }
  const double huge = 3.4e38, tiny = 1e-300;
  for (const double s : {huge, tiny}) {
    Points points = kComb;
    for (auto& [x, y] : points) x *= s / 8, y *= s / 8;
    EXPECT_EQ(triangulate_polygon(points).triangles.size(), 10U);
  }
}

struct Made {
  std::vector<std::uint32_t> indices;
  Vec3d area{0.0};       ///< the sum over the triangles, twice
  Vec3d of_border{0.0};  ///< the polygon's, by its sides
  bool is_said = false;  ///< that the shape is a guess
};

Made triangulate_face(const std::vector<Vec3d>& positions) {
  Made out;
  std::vector<std::uint32_t> polygon;
  for (std::uint32_t i = 0; i < positions.size(); ++i) polygon.push_back(i);
  FaceTriangles faces(positions);
  faces.append(polygon, out.indices);
  const auto at = [&](std::size_t i) { return positions[out.indices[i]]; };
  for (std::size_t i = 0; i + 2 < out.indices.size(); i += 3)
    out.area += glm::cross(at(i + 1) - at(i), at(i + 2) - at(i));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    out.of_border += glm::cross(positions[i], positions[(i + 1) % positions.size()]);
  }
  std::vector<LeftOut> left_out;
  faces.report(left_out);
  out.is_said = !left_out.empty();
  return out;
}

using Edge = std::array<std::uint32_t, 2>;

/// Sides of the polygon that no triangle has, and edges of triangles that are neither sides nor another triangle's.
std::vector<Edge> unmatched_edges(const std::vector<std::uint32_t>& indices, std::size_t sides) {
  std::map<Edge, int> balance;
  const auto add = [&](std::uint32_t a, std::uint32_t b, int count) {
    balance[{std::min(a, b), std::max(a, b)}] += a < b ? count : -count;
  };
  for (std::size_t i = 0; i < indices.size(); ++i) add(indices[i], indices[i / 3 * 3 + (i + 1) % 3], 1);
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i) add(i, (i + 1) % n, -1);
  std::vector<Edge> edges;
  for (const auto& [edge, count] : balance) {
    if (count != 0) edges.push_back(edge);
  }
  return edges;
}

/// Edges that hang together lie on one line: what is missing between them has no area.
bool is_flat(const std::vector<Vec3d>& positions, std::vector<Edge> edges) {
  while (!edges.empty()) {
    std::set<std::uint32_t> corners(edges.back().begin(), edges.back().end());
    const Vec3d& from = positions[edges.back()[0]];
    const Vec3d along = positions[edges.back()[1]] - from;
    for (std::size_t before = 0; before != edges.size();) {
      before = edges.size();
      std::erase_if(edges, [&](const Edge& e) {
        const bool hangs = corners.contains(e[0]) || corners.contains(e[1]);
        if (hangs) corners.insert(e.begin(), e.end());
        return hangs;
      });
    }
    for (const std::uint32_t c : corners) {
      if (glm::cross(along, positions[c] - from) != Vec3d(0.0)) return false;
    }
  }
  return true;
}

/// Sides that lie on one another from the front of a face that is not flat: trimesh's polygonfaces.obj.
TEST(FaceTriangles, CornersThatTheFrontDoesNotShowAreKept) {
  const std::vector<Vec3d> bent{{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, {0, 5, -5}};
  const Made made = triangulate_face(bent);
  EXPECT_EQ(made.indices.size(), 9U);
  EXPECT_EQ(made.area, made.of_border);
  EXPECT_FALSE(made.is_said);
  // Two corners in a row; and a spike that is one, which has no area to be kept.
  const Made two = triangulate_face({{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 1, -5}, {-4, 2, -5}, {0, 5, -5}});
  EXPECT_EQ(two.indices.size(), 12U);
  EXPECT_EQ(two.area, two.of_border);
  // Opposite walls, whose areas cancel; the bent one with a corner that is there twice; and with a hole, cut open.
  const Made walls = triangulate_face({{5, 0, -5}, {-5, 0, -5}, {0, 5, -5}, {-5, 0, 5}, {5, 0, 5}, {0, 5, 5}});
  EXPECT_EQ(walls.indices.size(), 12U);
  EXPECT_FALSE(walls.is_said);
  const Made twice = triangulate_face({{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, {0, 5, -5}, {0, 5, -5}});
  EXPECT_EQ(twice.indices.size(), 9U);
  EXPECT_EQ(twice.area, twice.of_border);
  const Made holed = triangulate_face({{-5, 0, 5},
                                       {2, 0, 2},
                                       {1, 0, 1},
                                       {2, 0, 1},
                                       {2, 0, 2},
                                       {-5, 0, 5},
                                       {5, 0, 5},
                                       {5, 0, -5},
                                       {-5, 0, -5},
                                       {0, 5, -5}});
  EXPECT_EQ(holed.area, holed.of_border);
  const Made flat = triangulate_face({{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}, {0, 0, -5}});
  EXPECT_EQ(flat.indices.size(), 6U);
  EXPECT_EQ(flat.area, flat.of_border);
}

/// Corners of a coarse grid, so that sides meet, fold and lie on one another in every way.
TEST(FaceTriangles, WhatIsMissingOfABentFaceIsSaid) {
  std::mt19937 random(1);
  int whole = 0, odd = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<Vec3d> positions(5 + random() % 4);
    for (Vec3d& p : positions) p = {random() % 4, random() % 4, random() % 4};
    if (std::set<std::array<double, 3>> places; !std::all_of(positions.begin(), positions.end(), [&](const Vec3d& p) {
          return places.insert({p.x, p.y, p.z}).second;
        })) {
      continue;
    }
    const Made made = triangulate_face(positions);
    whole += made.is_said ? 0 : 1;
    EXPECT_TRUE(made.is_said || glm::length(made.area - made.of_border) < 1e-9) << trial;
    if (!made.is_said && !is_flat(positions, unmatched_edges(made.indices, positions.size()))) ++odd;
  }
  EXPECT_GT(whole, 2000);
  EXPECT_LE(odd, 6);  // spikes that share a corner; sides that cross, seen edge-on
}

/// Large faces of an odd shape: the work of one, and of all together, is bounded.
TEST(FaceTriangles, ManyLargeDentedFacesTakeBoundedTime) {
  constexpr std::uint32_t kCorners = 4096;
  std::vector<Vec3d> positions;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const double angle = 6.283185307179586 * i / kCorners, radius = i % 2 == 0 ? 1000.0 : 1.0;
    positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  std::vector<std::uint32_t> polygon(kCorners);
  for (std::uint32_t i = 0; i < kCorners; ++i) polygon[i] = i;
  const auto start = std::chrono::steady_clock::now();
  FaceTriangles faces(positions);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::uint32_t> indices;
    faces.append(polygon, indices);
    EXPECT_EQ(indices.size(), 3 * (kCorners - 2));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(120));
  std::vector<LeftOut> left_out;
  faces.report(left_out);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0].what, "the shape of 72 dented faces");  // 128 are within 2^31 squares
}

}  // namespace
}  // namespace meshlode::scene
