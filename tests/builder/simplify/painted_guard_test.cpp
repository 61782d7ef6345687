// SPDX-License-Identifier: GPL-3.0-or-later
// What a collapse moves of what is painted, against every point and every triangle, and what comes of weighing it.
#include "builder/simplify/painted_guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/attribute_scales.h"
#include "support/drawn_mesh.h"
#include "support/random.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::closed_fan;
using test::DrawnMesh;
using test::random_point;
using test::RandomSource;
using test::seamed_fan;

using FiveQuadrics = AttributeQuadrics<double, 5>;
using FiveGuard = PaintedGuard<double, 5>;

/// As a collapse is weighed: its classes, its guard and what they look at.
struct WeighedEdge {
  DrawnMesh& drawn;
  SimplifyInput input;
  GroupLocks locks;
  FiveQuadrics attributes;
  WedgeClasses classes;
  CollapseStar star;

  /// Around the middle of the edge (0, 1), or around `target`.
  WeighedEdge(DrawnMesh& mesh, const SimplifyInput& in, std::optional<Vec3i> target = {})
      : drawn(mesh),
        input(in),
        locks(in.is_locked, in.is_wedge_shared, in.wedge_position),
        attributes(input, std::vector<double>(in.layout.stride(), 1.0), true),
        star(target ? mesh.star_at(mesh.places.to_frame(*target), 0, 1) : mesh.star(0, 1)) {
    if (in.layout.stride() == 0) return;
    for (std::uint32_t t = 0; t < drawn.mesh.triangle_count(); ++t) {
      const Face face = face_of(drawn.mesh, drawn.places, t);
      if (!(face.twice_area > 0.0)) continue;
      (void)attributes.add_face({drawn.mesh.wedge(3 * t), drawn.mesh.wedge(3 * t + 1), drawn.mesh.wedge(3 * t + 2)},
                                face);
    }
    classes.collect(drawn.mesh, locks, star.a, star.b);
  }

  [[nodiscard]] double distance2(const PaintedUnits& units, double least = 0.0) {
    FiveGuard guard(input, units, drawn.places);
    return guard.distance2(drawn.mesh, drawn.places, locks, star, classes, attributes, least);
  }
};

using Row = std::array<double, 11>;  // place, up to five values, normal of the triangle
using Rows = std::array<Row, 3>;

/// The two surfaces and all points, written down one by one.
struct Plain {
  const WeighedEdge& weighed;
  const PaintedUnits& units;
  double per_object;

  [[nodiscard]] Row point(const Vec3d& place, std::array<double, 5> v) const {
    const AttributeLayout& layout = weighed.input.layout;
    Row out{place.x, place.y, place.z};
    std::size_t d = 3;
    if (layout.has_normal) {
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      for (std::size_t k = 0; k < 3; ++k) out[d++] = per_object * units.normal * (length > 0.0 ? v[k] / length : 0.0);
    }
    for (std::size_t k = 0; k < 2 * layout.uv_set_count; ++k)
      out[d++] = per_object * units.uv[k / 2][k % 2] * v[layout.uv_offset() + k];
    return out;
  }
  [[nodiscard]] Row at(std::uint32_t corner) const {
    std::array<double, 5> v{};
    const std::size_t stride = weighed.input.layout.stride();
    for (std::size_t j = 0; j < stride; ++j)
      v[j] = double{weighed.input.wedge_attributes[weighed.drawn.mesh.wedge(corner) * stride + j]};
    return point(weighed.drawn.places[weighed.drawn.mesh.vertex(corner)], v);
  }
  [[nodiscard]] Row joined(std::uint32_t corner) const {
    std::array<double, 5> v{};
    const std::uint32_t wedge = weighed.drawn.mesh.wedge(corner);
    const std::size_t stride = weighed.input.layout.stride();
    for (std::size_t j = 0; j < stride; ++j) v[j] = double{weighed.input.wedge_attributes[wedge * stride + j]};
    const WedgeClasses& all = weighed.classes;
    if (all.count() == 0) return point(weighed.star.target, v);
    FiveQuadrics after = weighed.attributes;  // what the collapse itself does
    after.join(all);
    const std::uint32_t of = all.class_of(all.find(wedge));
    after.values_of(all.keeper(of), all.fixed(of) != kNoId, weighed.star.target, v);
    return point(weighed.star.target, v);
  }
  void shade(Rows& t) const {
    if (!weighed.input.layout.flat_normal) return;
    const auto place = [&](std::size_t k) { return Vec3d(t[k][0], t[k][1], t[k][2]); };
    const Vec3d n = glm::cross(place(1) - place(0), place(2) - place(0));
    const double length = glm::length(n);
    for (Row& p : t) {
      for (int k = 0; k < 3 && length > 0.0; ++k)
        p[8 + static_cast<std::size_t>(k)] = per_object * units.normal * n[k] / length;
    }
  }
  static Row mix(const Rows& t, double a, double b, double c) {
    Row out{};
    for (std::size_t d = 0; d < out.size(); ++d) out[d] = a * t[0][d] + b * t[1][d] + c * t[2][d];
    return out;
  }
  /// By a grid over the triangle, made finer around its best point.
  static double distance2(const Row& p, const Rows& t) {
    double best = std::numeric_limits<double>::infinity(), at_b = 1.0 / 3.0, at_c = 1.0 / 3.0, reach = 1.0;
    for (int round = 0; round < 20; ++round, reach *= 0.55) {
      const double from_b = at_b, from_c = at_c;
      for (int i = -3; i <= 3; ++i) {
        for (int k = -3; k <= 3; ++k) {
          const double b = std::clamp(from_b + reach * i / 3.0, 0.0, 1.0);
          const double c = std::clamp(from_c + reach * k / 3.0, 0.0, 1.0 - b);
          const Row q = mix(t, 1.0 - b - c, b, c);
          double sum = 0.0;
          for (std::size_t d = 0; d < p.size(); ++d) sum += (p[d] - q[d]) * (p[d] - q[d]);
          if (sum < best) best = sum, at_b = b, at_c = c;
        }
      }
    }
    return best;
  }
  [[nodiscard]] double largest2() const {
    std::vector<Rows> old, made;
    for (const Ring* end : {&weighed.star.a, &weighed.star.b}) {
      for (const std::uint32_t corner : end->corners()) {
        const std::uint32_t next = CollapseMesh::next_in_triangle(corner);
        old.push_back({at(corner), at(next), at(CollapseMesh::next_in_triangle(next))});
        shade(old.back());
      }
    }
    for (const CollapseStar::OuterEdge& edge : weighed.star.outer()) {
      const std::uint32_t next = CollapseMesh::next_in_triangle(edge.corner);
      made.push_back({joined(edge.corner), at(next), at(CollapseMesh::next_in_triangle(next))});
      shade(made.back());
    }
    const auto nearest = [](const Row& p, const std::vector<Rows>& to) {
      double least = std::numeric_limits<double>::infinity();
      for (const Rows& t : to) least = std::min(least, distance2(p, t));
      return least;
    };
    double largest = 0.0;
    for (const Rows& t : old) {
      largest =
          std::max({largest, nearest(mix(t, 1.0, 0.0, 0.0), made), nearest(mix(t, 1.0 / 3, 1.0 / 3, 1.0 / 3), made)});
      if (!weighed.input.layout.flat_normal) continue;
      largest = std::max({largest, nearest(mix(t, 0.0, 1.0, 0.0), made), nearest(mix(t, 0.0, 0.0, 1.0), made)});
    }
    for (const Rows& t : made) {
      largest = std::max({largest, nearest(mix(t, 0.5, 0.5, 0.0), old), nearest(mix(t, 0.5, 0.0, 0.5), old),
                          nearest(mix(t, 1.0 / 3, 1.0 / 3, 1.0 / 3), old)});
    }
    return largest;
  }
};

SimplifyInput two_to_one(const DrawnMesh& drawn) {
  SimplifyInput input = as_input(drawn);
  input.grid = {0, 1};
  input.layout.uv_set_count = 1;
  for (const std::uint32_t p : drawn.wedge_position) {
    input.wedge_attributes.push_back(static_cast<float>(drawn.points[p].x + 1));
    input.wedge_attributes.push_back(static_cast<float>(2 * drawn.points[p].y));
  }
  return input;
}

PaintedUnits units(double u, double v, double normal = 0.0) {
  PaintedUnits out;
  out.normal = normal;
  out.uv[0] = {u, v};
  return out;
}

TEST(PaintedGuard, ALinearTextureIsMovedByNothing) {
  DrawnMesh drawn = closed_fan();
  WeighedEdge weighed(drawn, two_to_one(drawn), Vec3i(3, 1, 0));
  EXPECT_NEAR(weighed.distance2(units(1.0, 1.0)), 0.0, 1e-12);
  EXPECT_FALSE(FiveGuard(weighed.input, {}, drawn.places).is_on()) << "nothing is promised";
  EXPECT_TRUE(FiveGuard(weighed.input, units(1.0, 1.0), drawn.places).is_on());
}

/// One corner of the texture is pulled by 3 in u, each unit of which counts 2: the plane stays, and the middle of it
/// moves.
TEST(PaintedGuard, AKinkInThePlaneCountsInItsUnit) {
  DrawnMesh drawn = closed_fan();
  SimplifyInput input = two_to_one(drawn);
  input.wedge_attributes[0] += 3.0F;
  WeighedEdge weighed(drawn, input);
  const double found = std::sqrt(weighed.distance2(units(2.0, 1.0))) * drawn.places.scale();
  EXPECT_GT(found, 1.0);
  EXPECT_LT(found, 6.0) << "what it was pulled by";
  const double doubled = std::sqrt(weighed.distance2(units(4.0, 1.0))) * drawn.places.scale();
  EXPECT_GT(doubled, found);
  EXPECT_EQ(weighed.distance2(units(2.0, 1.0), 100.0), 100.0) << "what nobody asks about";
  EXPECT_NEAR(weighed.distance2(units(0.0, 1.0)), 0.0, 1e-12) << "u does not count";
}

/// Beyond a seam values jump by ten thousand: no chart is measured against the other.
TEST(PaintedGuard, ChartsOfASeamAreKeptApart) {
  DrawnMesh drawn = seamed_fan();
  SimplifyInput input = two_to_one(drawn);
  for (std::size_t w = 10; w < 14; ++w) input.wedge_attributes[2 * w] += 1e4F;
  WeighedEdge weighed(drawn, input, Vec3i(1, 0, 0));  // on the seam
  EXPECT_NEAR(weighed.distance2(units(1.0, 1.0)), 0.0, 1e-9);
}

TEST(PaintedGuard, IsThatOfEveryPointAgainstEveryTriangle) {
  RandomSource random(211);
  int moved = 0, by_normal = 0;
  for (int round = 0; round < (test::kIsSanitized ? 60 : 400); ++round) {
    const std::uint32_t count = 5 + random.below(7);
    std::vector<Vec3i> points;
    for (std::uint32_t v = 0; v < count; ++v) points.push_back(random_point(random, 1000));
    std::vector<std::uint32_t> more;
    for (std::uint32_t n = random.below(4); n > 0; --n) more.push_back(random.below(3));
    const auto wedge_of = [&](std::uint32_t v) {  // its own, or one of the further ones
      std::vector<std::uint32_t> all{v};
      for (std::uint32_t i = 0; i < more.size(); ++i) {
        if (more[i] == v) all.push_back(count + i);
      }
      return all[random.below(static_cast<std::uint32_t>(all.size()))];
    };
    std::vector<WedgeTriangle> triangles;
    const auto other = [&] { return 2 + random.below(count - 2); };
    for (std::uint32_t n = 1 + random.below(2); n > 0; --n)
      triangles.push_back({wedge_of(0), wedge_of(1), wedge_of(other())});
    for (std::uint32_t n = 1 + random.below(6); n > 0; --n) {
      const std::uint32_t x = other(), y = other();
      if (x != y) triangles.push_back({wedge_of(random.below(2)), wedge_of(x), wedge_of(y)});
    }
    DrawnMesh drawn(points, triangles, more);
    SimplifyInput input = as_input(drawn);
    input.grid = {-3, 1};
    const int kind = round % 3;  // texture; texture and normals; normals of triangles
    input.layout.uv_set_count = 1;
    input.layout.has_normal = kind == 1;
    input.layout.flat_normal = kind == 2;
    for (std::size_t i = 0; i < drawn.wedge_position.size() * input.layout.stride(); ++i)
      input.wedge_attributes.push_back(static_cast<float>(random.between(-1.0, 1.0)));
    const PaintedUnits of = units(random.between(0.0, 100.0), random.between(0.0, 100.0), kind > 0 ? 30.0 : 0.0);
    WeighedEdge weighed(drawn, input, random_point(random, 1000));
    if (weighed.star.outer().empty()) continue;
    const double plain = Plain{weighed, of, 1.0 / (drawn.places.scale() * input.grid.step())}.largest2();
    EXPECT_NEAR(weighed.distance2(of), plain, 1e-4 * plain + 1e-9) << "seed 211, round " << round;
    EXPECT_EQ(weighed.distance2(of, 1.01 * plain + 1e-6), 1.01 * plain + 1e-6) << "seed 211, round " << round;
    ++moved;
    by_normal += kind == 2 ? 1 : 0;
  }
  EXPECT_GT(moved, 45);
  EXPECT_GT(by_normal, 12);
}

/// A further set of UVs that is the same everywhere moves nothing, though it is looked at.
TEST(PaintedGuard, MoreDimensionsThanMostMeshesHaveAreLookedAt) {
  DrawnMesh drawn = closed_fan();
  RandomSource random(213);
  SimplifyInput one = as_input(drawn), two;
  one.layout.uv_set_count = 1;
  one.layout.has_normal = true;
  for (std::size_t i = 0; i < drawn.wedge_position.size() * one.layout.stride(); ++i)
    one.wedge_attributes.push_back(static_cast<float>(random.between(-1.0, 1.0)));
  two = one;
  two.layout.uv_set_count = 2;
  two.wedge_attributes.clear();
  for (std::size_t w = 0; w < drawn.wedge_position.size(); ++w) {
    const auto own = one.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(5 * w);
    two.wedge_attributes.insert(two.wedge_attributes.end(), own, own + 5);
    two.wedge_attributes.insert(two.wedge_attributes.end(), {0.5F, 0.25F});
  }
  PaintedUnits of = units(2.0, 3.0, 5.0);
  WeighedEdge weighed(drawn, one);
  const double expected = weighed.distance2(of);
  of.uv[1] = {7.0, 11.0};
  using MostQuadrics = AttributeQuadrics<double, 15>;
  MostQuadrics attributes(two, std::vector<double>(two.layout.stride(), 1.0), true);
  for (std::uint32_t t = 0; t < drawn.mesh.triangle_count(); ++t) {
    (void)attributes.add_face({drawn.mesh.wedge(3 * t), drawn.mesh.wedge(3 * t + 1), drawn.mesh.wedge(3 * t + 2)},
                              face_of(drawn.mesh, drawn.places, t));
  }
  const GroupLocks locks(two.is_locked, two.is_wedge_shared, two.wedge_position);
  PaintedGuard<double, 15> guard(two, of, drawn.places);
  EXPECT_GT(expected, 0.0);
  EXPECT_NEAR(guard.distance2(drawn.mesh, drawn.places, locks, weighed.star, weighed.classes, attributes, 0.0),
              expected, 1e-9 * expected);
}

TEST(PaintedGuard, NumbersThatAreNoneDoNotSpread) {
  DrawnMesh drawn = closed_fan();
  SimplifyInput input = two_to_one(drawn);
  input.wedge_attributes[0] = std::numeric_limits<float>::quiet_NaN();
  input.wedge_attributes[3] = std::numeric_limits<float>::infinity();
  input.wedge_attributes[4] = 3e38F;
  WeighedEdge weighed(drawn, input);
  const double found = weighed.distance2(units(1e30, 1e30));
  EXPECT_TRUE(std::isfinite(found));
  EXPECT_GE(found, 0.0);
}

/// A flat sheet whose texture waves: as many triangles as without are left, and the worst point of the texture has
/// moved by less.
TEST(PaintedGuard, WhatIsPromisedMovesByLessAtTheSameNumberOfTriangles) {
  constexpr std::uint32_t kSide = 33;
  std::vector<Vec3i> points;
  std::vector<WedgeTriangle> triangles;
  for (std::int32_t y = 0; y < static_cast<std::int32_t>(kSide); ++y) {
    for (std::int32_t x = 0; x < static_cast<std::int32_t>(kSide); ++x) points.emplace_back(64 * x, 64 * y, 0);
  }
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t i = y * kSide + x;
      triangles.push_back({i, i + 1, i + kSide + 1});
      triangles.push_back({i, i + kSide + 1, i + kSide});
    }
  }
  const DrawnMesh drawn(points, triangles);
  SimplifyInput input = as_input(drawn);
  input.grid = {0, 1};
  input.layout.uv_set_count = 1;
  for (const Vec3i& p : points) {
    const double x = p.x / 2048.0, y = p.y / 2048.0;
    input.wedge_attributes.push_back(static_cast<float>(x + 0.05 * std::sin(9.0 * x) * std::sin(7.0 * y)));
    input.wedge_attributes.push_back(static_cast<float>(y));
  }
  SimplifyOptions options;
  options.target_triangles = 400;
  double worst[2] = {0.0, 0.0};
  for (const bool is_promised : {false, true}) {
    options.painted = is_promised ? units(2048.0, 2048.0) : PaintedUnits();
    const SimplifyResult result = simplify_group(input, options);
    EXPECT_LE(result.triangles.size(), 400U);
    for (std::size_t i = 0; i < points.size(); ++i) {  // where each point of the sheet lies now, what is painted there
      const Vec2d p(points[i].x, points[i].y);
      double nearest = std::numeric_limits<double>::infinity();
      for (const WedgeTriangle& t : result.triangles) {
        const auto at = [&](std::size_t k) {
          const Vec3i& q = result.positions[result.wedge_position[t[k]]];
          return Vec2d(q.x, q.y);
        };
        const Vec2d e = at(1) - at(0), f = at(2) - at(0), d = p - at(0);
        const double area = e.x * f.y - e.y * f.x;
        const double b = (d.x * f.y - d.y * f.x) / area, c = (e.x * d.y - e.y * d.x) / area;
        if (!(b >= -1e-9) || !(c >= -1e-9) || !(b + c <= 1.0 + 1e-9)) continue;
        const auto u = [&](std::size_t k) { return double{result.wedge_attributes[2 * t[k]]}; };
        const double off = u(0) + b * (u(1) - u(0)) + c * (u(2) - u(0)) - double{input.wedge_attributes[2 * i]};
        nearest = std::min(nearest, std::abs(off));
      }
      if (std::isfinite(nearest)) worst[is_promised ? 1 : 0] = std::max(worst[is_promised ? 1 : 0], nearest);
    }
  }
  EXPECT_GT(worst[0], 0.0);
  EXPECT_LT(worst[1], 0.8 * worst[0]) << worst[1] << " against " << worst[0];
}

}  // namespace
}  // namespace meshlode::builder
