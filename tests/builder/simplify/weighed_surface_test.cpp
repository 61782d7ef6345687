// SPDX-License-Identifier: GPL-3.0-or-later
// What a collapse is charged for, against the definitions and with eleven more bits: attributes that are linear on each
// face, planes and walls, the scales of attributes, and how far pieces grow.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/attribute_quadrics.h"
#include "builder/simplify/attribute_scales.h"
#include "builder/simplify/pieces.h"
#include "support/drawn_mesh.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::closed_fan;
using test::DrawnMesh;
using test::open_fan;

using Real3 = glm::vec<3, long double>;

/// The fan with its points moved by up to `jitter` of hundred units, in all three axes.
DrawnMesh uneven_fan(test::RandomSource& random, bool is_open, std::uint32_t jitter) {
  const DrawnMesh even = is_open ? open_fan() : closed_fan();
  std::vector<Vec3i> points;
  for (const Vec3i& p : even.points) points.push_back(p * 100 + test::random_point(random, jitter));
  return {points, even.triangles};
}

struct ExactFace {
  Real3 p, normal;
  long double area = 0.0L;
  std::array<Real3, 3> corner;
};

ExactFace exact_face(const DrawnMesh& drawn, std::size_t t) {
  ExactFace face;
  for (std::size_t k = 0; k < 3; ++k) face.corner[k] = Real3(drawn.places[drawn.wedge_position[drawn.triangles[t][k]]]);
  face.p = face.corner[0];
  const Real3 n = glm::cross(face.corner[1] - face.p, face.corner[2] - face.p);
  const long double length = std::sqrt(glm::dot(n, n));
  face.area = length / 2.0L;
  face.normal = n / length;
  return face;
}

/// The value at `place` of what is linear on the face and constant across it.
long double extrapolated(const ExactFace& face, const std::array<long double, 3>& at, const Real3& place) {
  const Real3 foot = place - face.normal * glm::dot(place - face.p, face.normal);
  long double value = 0.0L;
  for (std::size_t k = 0; k < 3; ++k) {
    const Real3 a = face.corner[(k + 1) % 3] - foot, b = face.corner[(k + 2) % 3] - foot;
    value += at[k] * glm::dot(glm::cross(a, b), face.normal) / (2.0L * face.area);
  }
  return value;
}

constexpr std::size_t kCount = 5;  // a normal and a set of coordinates, in quadrics of six

TEST(WeighedSurface, AttributesCostWhatEachFaceSaysOfThem) {
  test::RandomSource random(141);
  for (int round = 0; round < 300; ++round) {
    const DrawnMesh drawn = uneven_fan(random, round % 2 == 0, 90);
    SimplifyInput input = as_input(drawn);
    input.layout.has_normal = true;
    input.layout.uv_set_count = 1;
    for (std::size_t i = 0; i < drawn.points.size() * kCount; ++i)
      input.wedge_attributes.push_back(static_cast<float>(random.signed_unit()));
    std::vector<double> scales(kCount);
    for (double& scale : scales) scale = random.log_between(0.1, 10.0);
    AttributeQuadrics<double, 6> attributes(input, scales, true);
    for (std::uint32_t t = 0; t < drawn.triangles.size(); ++t)
      (void)attributes.add_face(drawn.triangles[t], face_of(drawn.mesh, drawn.places, t));

    const std::vector<std::uint32_t> members =
        round % 3 == 0 ? std::vector<std::uint32_t>{0} : std::vector<std::uint32_t>{0, 1};
    const Vec3d place = random.in_cube(1.0);
    const std::uint32_t fixed = round % 4 < 2 ? kNoId : members[round / 4 % members.size()];
    // Each face as often as it has members, with its area, and the mean of what they say.
    std::array<long double, kCount> mean{}, best{};
    long double weight = 0.0L, error = 0.0L, size = 0.0L;
    for (const bool is_sum : {false, true}) {
      for (std::size_t t = 0; t < drawn.triangles.size(); ++t) {
        const ExactFace face = exact_face(drawn, t);
        for (const std::uint32_t wedge : drawn.triangles[t]) {
          if (std::find(members.begin(), members.end(), wedge) == members.end()) continue;
          if (!is_sum) weight += face.area;
          for (std::size_t j = 0; j < kCount; ++j) {
            std::array<long double, 3> at;
            for (std::size_t k = 0; k < 3; ++k)
              at[k] = static_cast<long double>(scales[j]) * input.wedge_attributes[drawn.triangles[t][k] * kCount + j];
            const long double value = extrapolated(face, at, Real3(place));
            if (!is_sum) {
              mean[j] += face.area * value;
              continue;
            }
            const long double off = value - best[j];
            error += face.area * off * off;
            size += face.area * (value * value + best[j] * best[j]);
          }
        }
      }
      if (is_sum) continue;
      for (std::size_t j = 0; j < kCount; ++j) {
        const std::uint32_t from = fixed == kNoId ? 0 : fixed;
        best[j] = fixed == kNoId ? mean[j] / weight
                                 : static_cast<long double>(scales[j]) * input.wedge_attributes[from * kCount + j];
      }
    }
    const auto tolerance = static_cast<double>(1e-12L * size);
    GroupLocks locks(std::vector<std::uint8_t>(10, 0), std::vector<std::uint8_t>(10, 0), drawn.wedge_position);
    if (fixed != kNoId) locks.is_wedge_locked[fixed] = 1;
    WedgeClasses classes;
    classes.set_pair(locks, members.front(), members.back());
    Quadric total;
    for (const std::uint32_t w : members) total += AttributeQuadrics<double, 6>(attributes).take_base(w);
    const double fixed_error = attributes.add_classes(total, classes, place);
    EXPECT_NEAR(total.evaluate(place) + fixed_error, static_cast<double>(error), tolerance)
        << "seed 141, round " << round;
    if (fixed != kNoId) continue;
    EXPECT_EQ(fixed_error, 0.0);
    attributes.join(classes);
    std::vector<float> written;
    attributes.write(members[0], false, place, written);
    // What is stored is a float, and of that the normal of length one.
    std::array<float, kCount> stored;
    for (std::size_t j = 0; j < kCount; ++j) stored[j] = static_cast<float>(static_cast<double>(best[j] / scales[j]));
    const Real3 normal(stored[0], stored[1], stored[2]);
    const Real3 unit = normal / std::sqrt(glm::dot(normal, normal));
    for (std::size_t j = 0; j < kCount; ++j) {
      const double value = j < 3 ? static_cast<double>(unit[static_cast<int>(j)]) : double{stored[j]};
      EXPECT_NEAR(written[j], value, 0x1.001p-24 * std::fabs(value) + 1e-11) << "seed 141, round " << round;
    }
  }
}

WedgeClasses pair_of(const DrawnMesh& drawn, std::uint32_t x, std::uint32_t y) {
  const std::vector<std::uint8_t> none(drawn.wedge_position.size(), 0);
  WedgeClasses classes;
  classes.set_pair(GroupLocks(none, none, drawn.wedge_position), x, y);
  return classes;
}

// A face is a sliver where it is lower than a thousandth of its longest edge, whichever that is.
TEST(WeighedSurface, AcrossLessThanAThousandthNothingIsLinear) {
  for (const int height : {99, 101}) {
    for (std::uint32_t first = 0; first < 3; ++first) {
      const std::array<Vec3i, 3> corner{Vec3i(0, 0, 0), Vec3i(100000, 0, 0), Vec3i(50000, height, 0)};
      const DrawnMesh drawn({corner[first], corner[(first + 1) % 3], corner[(first + 2) % 3]}, {{0, 1, 2}});
      SimplifyInput input = as_input(drawn);
      input.layout.uv_set_count = 1;
      for (const Vec3i& p : drawn.points) {
        for (const double value : {p.x / 100000.0, 1.0}) input.wedge_attributes.push_back(static_cast<float>(value));
      }
      AttributeQuadrics<double, 2> attributes(input, {1.0, 1.0}, false);
      (void)attributes.add_face({0, 1, 2}, face_of(drawn.mesh, drawn.places, 0));
      attributes.join(pair_of(drawn, 0, 0));
      std::vector<float> written;
      attributes.write(0, false, drawn.places.to_frame({100000, 0, 0}), written);
      EXPECT_NEAR(written[0], height < 100 ? 0.5 : 1.0, 1e-5) << height << ", from corner " << first;
      EXPECT_NEAR(written[1], 1.0, 1e-6);
    }
  }
}

// Values of any size count, and come back from any scale; only what has no scale at all is left as it came.
TEST(WeighedSurface, TinyScalesAndTinyNormalsAreNotNothing) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  input.layout.has_normal = true;
  for (std::size_t v = 0; v < drawn.points.size(); ++v) {
    for (const float value : {0.6e-20F, 0.0F, -0.8e-20F}) input.wedge_attributes.push_back(value);
  }
  AttributeQuadrics<double, 3> attributes(input, {1e-20, 1e-20, 1e-20}, false);
  for (std::uint32_t t = 0; t < drawn.triangles.size(); ++t)
    (void)attributes.add_face(drawn.triangles[t], face_of(drawn.mesh, drawn.places, t));
  attributes.join(pair_of(drawn, 0, 1));
  std::vector<float> written;
  attributes.write(0, false, Vec3d(0.0), written);
  EXPECT_NEAR(written[0], 0.6, 1e-6);
  EXPECT_NEAR(written[1], 0.0, 1e-6);
  EXPECT_NEAR(written[2], -0.8, 1e-6);
}

TEST(WeighedSurface, PlanesCostTheSquaredHeightOverEachFace) {
  test::RandomSource random(142);
  for (int round = 0; round < 300; ++round) {
    const DrawnMesh drawn = uneven_fan(random, round % 2 == 0, 120);
    SurfaceQuadrics<double> surface(drawn.points.size(), 3.0);
    for (std::uint32_t t = 0; t < drawn.triangles.size(); ++t)
      surface.add_face(drawn.triangles[t], face_of(drawn.mesh, drawn.places, t));
    const Vec3d place = random.in_cube(1.0);
    long double error = 0.0L, area = 0.0L, total = 0.0L, size = 0.0L;
    for (std::size_t t = 0; t < drawn.triangles.size(); ++t) {
      const ExactFace face = exact_face(drawn, t);
      const long double height = glm::dot(Real3(place) - face.p, face.normal);
      total += 3.0L * face.area;
      for (const std::uint32_t v : drawn.triangles[t]) {
        if (v > 1) continue;
        error += face.area * height * height;
        area += face.area;
        size += face.area * (glm::dot(face.p, face.p) + glm::dot(place, place));
      }
    }
    EXPECT_NEAR(surface.around(0, 1).evaluate(place), static_cast<double>(error), static_cast<double>(1e-14L * size))
        << "seed 142, round " << round;
    EXPECT_NEAR(surface.around(0, 1).weight, static_cast<double>(area), static_cast<double>(1e-14L * area));
    EXPECT_NEAR(surface.total_weight(), static_cast<double>(total), static_cast<double>(1e-14L * total));
    EXPECT_NEAR(std::sqrt(surface.join(0, 1, place)), static_cast<double>(std::sqrt(error / area)),
                static_cast<double>(std::sqrt(1e-14L * size / area)))
        << "seed 142, round " << round;
  }
}

// A wall stands on its edge and on the triangle: what is off it across the triangle counts, times the edge's square.
TEST(WeighedSurface, WallsCostTheSquaredWayAcrossThem) {
  test::RandomSource random(143);
  for (int round = 0; round < 300; ++round) {
    const DrawnMesh drawn = uneven_fan(random, true, 120);
    // Of the triangle (0, 4, 5) its edge (0, 4), of (1, 2, 3) the edge (1, 2); as borders, or one as a seam of
    // weight 7.
    const bool is_border = round % 3 != 0;
    const std::vector<HeldEdge> edges{{0, 4, 3, is_border ? 1.0 : 7.0, is_border}, {1, 2, 0, 1.0, true}};
    SurfaceQuadrics<double> surface(drawn.points.size(), 5.0);
    surface.add_walls(edges, drawn.mesh, drawn.places);
    const Vec3d place = random.in_cube(1.0);
    long double error = 0.0L, of_borders = 0.0L, border_weight = 0.0L, size = 0.0L;
    for (const HeldEdge& held : edges) {
      const ExactFace face = exact_face(drawn, held.triangle);
      const Real3 a(drawn.places[held.a]), edge = Real3(drawn.places[held.b]) - a;
      const Real3 across = glm::cross(face.normal, edge);
      const long double length2 = glm::dot(edge, edge), off = glm::dot(across, Real3(place) - a);
      // |across| is the edge's length: off² is the distance's square times the edge's.
      const long double one = off * off * (held.is_border ? 1.0L : static_cast<long double>(held.weight));
      error += one * (held.is_border ? 5.0L : 1.0L);
      size += length2 * (glm::dot(a, a) + glm::dot(place, place)) * 7.0L;
      if (!held.is_border) continue;
      of_borders += one;
      border_weight += length2;
    }
    EXPECT_NEAR(surface.around(0, 1).evaluate(place), static_cast<double>(error), static_cast<double>(1e-14L * size))
        << "seed 143, round " << round;
    EXPECT_EQ(surface.around(0, 1).weight, 0.0) << "walls have no area";
    EXPECT_GT(surface.around(4, 4).evaluate(place), 0.0) << "the other end has it too";
    EXPECT_EQ(surface.around(3, 6).evaluate(place), 0.0) << "no one else";
    EXPECT_NEAR(std::sqrt(surface.join(0, 1, place)), static_cast<double>(std::sqrt(of_borders / border_weight)), 1e-7)
        << "the seam is no border: seed 143, round " << round;
    EXPECT_NEAR(surface.around(0, 0).evaluate(place), 2.0 * static_cast<double>(error),
                static_cast<double>(2e-14L * size))
        << "after joining, 0 has the walls of both";
  }
}

TEST(WeighedSurface, AnEdgeWithoutATriangleHasNoWallAndATinyOneHas) {
  const DrawnMesh flat({{0, 0, 0}, {4, 0, 0}, {8, 0, 0}, {0, 4, 0}}, {{0, 1, 2}, {0, 1, 3}});
  SurfaceQuadrics<double> none(4, 5.0);
  none.add_walls(std::vector<HeldEdge>{{0, 1, 0, 1.0, true}}, flat.mesh, flat.places);
  EXPECT_EQ(none.around(0, 1).evaluate(Vec3d(0.3, 0.4, 0.5)), 0.0);
  // One grid unit in eight million: its wall is as upright as any.
  const int most = 1 << 22;
  const DrawnMesh tiny({{-most, 0, 0}, {1 - most, 0, 0}, {-most, 1, 0}, {most, 0, 0}}, {{0, 1, 2}, {0, 1, 3}});
  SurfaceQuadrics<double> surface(4, 1.0);
  surface.add_walls(std::vector<HeldEdge>{{0, 1, 0, 1.0, true}}, tiny.mesh, tiny.places);
  const double unit = 1.0 / tiny.places.scale();
  EXPECT_NEAR(surface.around(0, 1).evaluate(Vec3d(0.0, 1.0, 0.0)), 2.0 * unit * unit, 1e-6 * unit * unit);
}

TEST(WeighedSurface, ScalesAreThoseOfTheSurfacesSize) {
  test::RandomSource random(144);
  for (int round = 0; round < 300; ++round) {
    const DrawnMesh drawn = uneven_fan(random, round % 2 == 0, 120);
    SimplifyInput input = as_input(drawn);
    input.layout.has_normal = true;
    input.layout.uv_set_count = 2;
    input.layout.has_color = true;
    for (std::size_t i = 0; i < drawn.points.size() * 11; ++i)
      input.wedge_attributes.push_back(static_cast<float>(random.signed_unit()));
    SimplifyOptions options;
    options.normal_weight = 3.0;
    options.uv_weight = 5.0;
    options.color_weight = 11.0;
    long double surface = 0.0L;
    std::array<long double, 2> covered{};
    for (std::size_t t = 0; t < drawn.triangles.size(); ++t) {
      surface += exact_face(drawn, t).area;
      for (std::size_t set = 0; set < 2; ++set) {
        std::array<std::array<long double, 2>, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
          for (std::size_t axis = 0; axis < 2; ++axis)
            uv[k][axis] = input.wedge_attributes[drawn.triangles[t][k] * 11 + 3 + 2 * set + axis];
        }
        covered[set] +=
            std::fabs((uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0])) /
            2.0L;
      }
    }
    const std::vector<double> scales = attribute_scales(input, options, drawn.mesh, drawn.places);
    ASSERT_EQ(scales.size(), 11U);
    const auto side = static_cast<double>(std::min(0.05L, std::sqrt(surface / drawn.triangles.size())));
    for (std::size_t j = 0; j < 11; ++j) {
      const double expected = j < 3    ? 3.0 * side
                              : j >= 7 ? 11.0 * side
                                       : static_cast<double>(5.0L * std::sqrt(surface / covered[(j - 3) / 2]));
      EXPECT_NEAR(scales[j], expected, 1e-14 * expected) << "seed 144, round " << round << ", float " << j;
    }
  }
}

// Where coordinates cover next to nothing their scale is large, as long as it is a number at all.
TEST(WeighedSurface, CoordinatesOfAnySpreadHaveAScale) {
  const DrawnMesh drawn = closed_fan();
  SimplifyInput input = as_input(drawn);
  input.layout.uv_set_count = 1;
  for (const float spread : {1e-18F, 1.0F, 1e18F}) {
    input.wedge_attributes.clear();
    for (const Vec3i& p : drawn.points) {
      for (const int c : {p.x, p.y}) input.wedge_attributes.push_back(static_cast<float>(c) * spread);
    }
    const std::vector<double> scales = attribute_scales(input, {}, drawn.mesh, drawn.places);
    const double expected = SimplifyOptions{}.uv_weight / (double{spread} * drawn.places.scale());
    for (const double scale : scales) EXPECT_NEAR(scale, expected, 1e-6 * expected) << spread;
  }
}

// A triangle that has gone covers nothing, neither of the surface nor of a texture.
TEST(WeighedSurface, ScalesAreOfTheLivingTriangles) {
  test::RandomSource random(145);
  DrawnMesh whole = uneven_fan(random, false, 60);
  const auto shaded = [&](const DrawnMesh& drawn) {
    SimplifyInput input = as_input(drawn);
    input.layout.uv_set_count = 1;
    test::RandomSource again(146);
    for (std::size_t i = 0; i < drawn.points.size() * 2; ++i)
      input.wedge_attributes.push_back(static_cast<float>(again.signed_unit()));
    return input;
  };
  std::vector<WedgeTriangle> rest;
  for (const WedgeTriangle& t : whole.triangles) {
    if (std::count(t.begin(), t.end(), 6) == 0 || std::count(t.begin(), t.end(), 7) == 0) rest.push_back(t);
  }
  const DrawnMesh part(whole.points, rest);
  ASSERT_EQ(rest.size() + 1, whole.triangles.size());
  // 6 and 7 become one: their triangle goes. Where they are does not change with it.
  std::vector<Vec3i> points = whole.points;
  points[7] = points[6];
  DrawnMesh joined(points, whole.triangles), other(points, rest);
  joined.join(6, 7);
  const std::vector<double> a = attribute_scales(shaded(joined), {}, joined.mesh, joined.places);
  const std::vector<double> b = attribute_scales(shaded(other), {}, other.mesh, other.places);
  for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(a[j], b[j], 1e-12 * b[j]);
}

// By one factor about its own middle, each piece alike, until all cover what the input did; twice at most.
TEST(WeighedSurface, FreePiecesGrowByOneFactorAboutTheirMiddles) {
  test::RandomSource random(147);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3i> points;
    std::vector<WedgeTriangle> triangles;
    const std::uint32_t count = 3 + random.below(4);
    for (std::uint32_t piece = 0; piece < count; ++piece) {  // two triangles each
      const Vec3i at = test::random_point(random, 1000000);
      for (int k = 0; k < 4; ++k) points.push_back(at + test::random_point(random, 200000));
      triangles.push_back({4 * piece, 4 * piece + 1, 4 * piece + 2});
      triangles.push_back({4 * piece, 4 * piece + 2, 4 * piece + 3});
    }
    DrawnMesh drawn(points, triangles);
    SimplifyInput input = as_input(drawn);
    const std::uint32_t locked = random.below(3);  // the first piece, or none
    if (locked == 1) input.is_locked[random.below(4)] = 1;
    const GroupPlaces before = drawn.places;
    const auto area_of = [&](const WedgeTriangle& t) {
      const Real3 a(before[t[0]]), n = glm::cross(Real3(before[t[1]]) - a, Real3(before[t[2]]) - a);
      return std::sqrt(glm::dot(n, n)) / 2.0L;
    };
    long double covered = 0.0L, fixed = 0.0L, free = 0.0L;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      covered += area_of(triangles[t]);
      (locked == 1 && t < 2 ? fixed : free) += area_of(triangles[t]);
    }
    // The input covered more by a copy of the last piece, or several.
    for (std::uint32_t copy = random.below(12); copy > 0; --copy) {
      for (std::size_t t = triangles.size() - 2; t < triangles.size(); ++t) {
        input.triangles.push_back(triangles[t]);
        covered += area_of(triangles[t]);
      }
    }
    const long double growth = std::min(2.0L, std::sqrt((covered - fixed) / free));
    const double moved = grow_pieces(input, drawn.mesh, drawn.places);
    long double farthest = 0.0L;
    for (std::uint32_t piece = 0; piece < count; ++piece) {
      Real3 moment(0.0L);
      long double area = 0.0L;
      for (std::size_t t = 2 * piece; t < 2 * piece + 2; ++t) {
        Real3 sum(0.0L);
        for (const std::uint32_t v : triangles[t]) sum += Real3(before[v]);
        moment += sum * (area_of(triangles[t]) / 3.0L);
        area += area_of(triangles[t]);
      }
      const Real3 middle = moment / area;
      for (std::uint32_t v = 4 * piece; v < 4 * piece + 4; ++v) {
        if (locked == 1 && piece == 0) {
          ASSERT_EQ(drawn.places.on_grid(v), points[v]);
          continue;
        }
        const Real3 way = (Real3(before[v]) - middle) * (growth - 1.0L);
        farthest = std::max(farthest, std::sqrt(glm::dot(way, way)));
        const Vec3d expected(Real3(before[v]) + way);
        ASSERT_EQ(drawn.places.on_grid(v), before.to_grid(expected)) << "seed 147, round " << round;
      }
    }
    ASSERT_NEAR(moved, static_cast<double>(growth > 1.0L ? farthest : 0.0L), 1e-14) << "seed 147, round " << round;
  }
}

// A piece of a few units of the grid in a group of millions is a piece.
TEST(WeighedSurface, TinyPiecesGrowToo) {
  const int most = 1 << 22;
  DrawnMesh drawn({{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {-most, 0, 0}, {most, 0, 0}, {0, most, 0}}, {{0, 1, 2}, {3, 4, 5}});
  SimplifyInput input = as_input(drawn);
  for (int copy = 0; copy < 8; ++copy) input.triangles.push_back({3, 4, 5});
  EXPECT_GT(grow_pieces(input, drawn.mesh, drawn.places), 0.0);
  EXPECT_EQ(drawn.places.on_grid(1), Vec3i(5, -1, 0)) << "twice as far from its middle (1, 1, 0)";
}

}  // namespace
}  // namespace meshlode::builder
