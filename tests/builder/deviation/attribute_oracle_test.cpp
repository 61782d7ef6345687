// SPDX-License-Identifier: GPL-3.0-or-later
// Normal and UV deviations against their definition: with eleven more bits, of sheets with random attributes over a
// flat source, on which the nearest point is straight below.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "builder/deviation/attribute_deviation.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

using Long2 = glm::vec<2, long double>;
using Long3 = glm::vec<3, long double>;
using Shares = std::array<long double, 3>;

constexpr std::size_t kStride = 7;  // a normal and two sets

AttributeLayout normal_and_two_sets() {
  AttributeLayout layout;
  layout.has_normal = true;
  layout.uv_set_count = 2;
  return layout;
}

struct ShadedSurface {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<float> attributes;

  [[nodiscard]] Long3 at(std::size_t t, std::size_t k) const { return Long3(positions[triangles[t][k]]); }
  [[nodiscard]] long double value(std::size_t t, std::size_t j, const Shares& w) const {
    long double sum = 0.0L;
    for (std::size_t k = 0; k < 3; ++k) sum += w[k] * attributes[triangles[t][k] * kStride + j];
    return sum;
  }
  [[nodiscard]] Long3 normal(std::size_t t, const Shares& w) const {
    const Long3 n(value(t, 0, w), value(t, 1, w), value(t, 2, w));
    const long double length = std::sqrt(glm::dot(n, n));
    return length > 0.0L ? n / length : n;
  }
};

/// A square of n by n cells in the plane y = 0, each vertex with attributes of its own.
ShadedSurface flat_source(test::RandomSource& random, std::uint32_t n, double size) {
  ShadedSurface source;
  for (std::uint32_t j = 0; j <= n; ++j) {
    for (std::uint32_t i = 0; i <= n; ++i) {
      source.positions.push_back(Vec3d(size * i / n, 0.0, size * j / n));
      const Vec3d normal = random.direction();
      for (const double value :
           {normal.x, normal.y, normal.z, random.unit(), random.unit(), random.unit(), random.unit()})
        source.attributes.push_back(static_cast<float>(value));
    }
  }
  for (std::uint32_t j = 0; j < n; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t at = j * (n + 1) + i;
      source.triangles.push_back({at, at + n + 2, at + 1});
      source.triangles.push_back({at, at + n + 1, at + n + 2});
    }
  }
  return source;
}

/// Where the point straight below is: the triangle and its shares.
std::pair<std::size_t, Shares> below(const ShadedSurface& source, const Long3& p) {
  for (std::size_t t = 0; t < source.triangles.size(); ++t) {
    const Long3 a = source.at(t, 0), b = source.at(t, 1) - a, c = source.at(t, 2) - a, d = p - a;
    const long double area = b.x * c.z - b.z * c.x;
    const long double at_b = (d.x * c.z - d.z * c.x) / area, at_c = (b.x * d.z - b.z * d.x) / area;
    if (at_b >= 0.0L && at_c >= 0.0L && at_b + at_c <= 1.0L) return {t, {1.0L - at_b - at_c, at_b, at_c}};
  }
  ADD_FAILURE() << "not above the source";
  return {};
}

/// Point `number` of the sequence R2 (Roberts 2018), folded into the triangle: of a step in each direction 1/g and
/// 1/g^2 with g^3 = g + 1.
Shares sequence(std::uint32_t number) {
  long double g = 1.3L;
  for (int turn = 0; turn < 20; ++turn) g -= (g * g * g - g - 1.0L) / (3.0L * g * g - 1.0L);
  long double whole = 0.0L;
  const long double b = std::modf(0.5L + number / g, &whole), c = std::modf(0.5L + number / (g * g), &whole);
  return b + c <= 1.0L ? Shares{1.0L - b - c, b, c} : Shares{b + c - 1.0L, 1.0L - b, 1.0L - c};
}

AttributeDeviation expected_deviation(const ShadedSurface& source, const ShadedSurface& group) {
  std::vector<long double> end;  // of the triangles, by area from the first one on
  for (std::size_t t = 0; t < group.triangles.size(); ++t) {
    const Long3 cross = glm::cross(group.at(t, 1) - group.at(t, 0), group.at(t, 2) - group.at(t, 0));
    end.push_back((end.empty() ? 0.0L : end.back()) + std::sqrt(glm::dot(cross, cross)));
  }
  long double total = 0.0L, chords2 = 0.0L;
  std::array<std::vector<std::pair<long double, long double>>, 2> uv_errors;
  for (std::uint32_t number = 0; number < kPointsForUvs; ++number) {
    // In the middle of one of as many equal parts.
    const long double area = end.back() / kPointsForUvs, here = area * (number + 0.5L);
    const auto t = static_cast<std::size_t>(std::lower_bound(end.begin(), end.end(), here) - end.begin());
    const Shares w = sequence(number);
    const auto [at, there] = below(source, group.at(t, 0) * w[0] + group.at(t, 1) * w[1] + group.at(t, 2) * w[2]);
    const Long3 chord = group.normal(t, w) - source.normal(at, there);
    total += area;
    chords2 += area * glm::dot(chord, chord);
    for (std::size_t set = 0; set < 2; ++set) {
      const Long2 off(group.value(t, 3 + 2 * set, w) - source.value(at, 3 + 2 * set, there),
                      group.value(t, 4 + 2 * set, w) - source.value(at, 4 + 2 * set, there));
      uv_errors[set].push_back({std::sqrt(glm::dot(off, off)), area});
    }
  }
  AttributeDeviation out;
  constexpr long double kDegreesOfOne = 57.295779513082320876798154814105L;
  out.normal = static_cast<double>(2.0L * kDegreesOfOne * std::asin(std::min(1.0L, std::sqrt(chords2 / total) / 2.0L)));
  for (auto& errors : uv_errors) {
    std::sort(errors.begin(), errors.end());
    long double covered = 0.0L;
    for (const auto& [error, area] : errors) {
      covered += area;
      if (covered < 0.95L * total) continue;
      out.uv = std::max(out.uv, static_cast<double>(error));
      break;
    }
  }
  return out;
}

AttributeDeviation measured(const ShadedSurface& source, const ShadedSurface& group) {
  return measure_attributes(SourceTree(source.positions, source.triangles), {source.attributes, source.triangles},
                            {group.positions, group.triangles}, {group.attributes, group.triangles},
                            normal_and_two_sets());
}

/// Triangles above the inside of the source. `spread` is how much their attributes differ from those below.
ShadedSurface group_above(test::RandomSource& random, const ShadedSurface& source, std::uint32_t count, double size,
                          double spread) {
  ShadedSurface group;
  for (std::uint32_t t = 0; t < count; ++t) {
    const double reach = 0.1 * random.log_between(1e-2, 1.0);
    std::array<Vec3d, 3> corners;
    // Above one triangle of the source: beside an edge of it floats may choose the triangle beyond.
    for (bool is_clear = false; !is_clear;) {
      const Vec3d middle(random.between(0.15, 0.85), random.between(-0.1, 0.1), random.between(0.15, 0.85));
      for (Vec3d& corner : corners) corner = (middle + random.in_cube(reach)) * size;
      is_clear = true;
      for (const Vec3d& corner : corners) {
        const auto [at, there] = below(source, Long3(corner));
        is_clear = is_clear && at == below(source, Long3(corners[0])).first;
        for (const long double share : there) is_clear = is_clear && share > 1e-3L;
      }
    }
    // Of any length, since it is their direction that counts; every eighth has none.
    const double length = t % 8 == 7 ? 0.0 : random.log_between(1e-15, 1e3);
    const std::uint32_t first = 3 * t;
    group.triangles.push_back({first, first + 1, first + 2});
    for (std::uint32_t k = 0; k < 3; ++k) {
      group.positions.push_back(corners[k]);
      const auto [at, there] = below(source, Long3(group.positions.back()));
      const Vec3d normal = glm::normalize(Vec3d(source.normal(at, there)) + random.in_cube(spread)) * length;
      for (int axis = 0; axis < 3; ++axis) group.attributes.push_back(static_cast<float>(normal[axis]));
      for (std::size_t j = 3; j < kStride; ++j) {
        // The second set is off by more in every other group.
        const double off = spread * random.signed_unit() * (j >= 5 && count % 2 == 1 ? 2.0 : 1.0);
        group.attributes.push_back(static_cast<float>(static_cast<double>(source.value(at, j, there)) + off));
      }
    }
  }
  return group;
}

TEST(AttributeOracle, EveryPointIsComparedWithTheOneBelow) {
  test::RandomSource random(121);
  for (int round = 0; round < 60; ++round) {
    const double size = round % 3 == 0 ? 1e-7 : round % 3 == 1 ? 1.0 : 1e5;
    const std::uint32_t count = round < 54 ? 1 + random.below(40) : 495 + random.below(12);
    const ShadedSurface source = flat_source(random, 1 + random.below(4), size);
    const ShadedSurface group = group_above(random, source, count, size, random.log_between(1e-2, 2.0));
    const AttributeDeviation found = measured(source, group), expected = expected_deviation(source, group);
    EXPECT_NEAR(found.normal, expected.normal, 1e-12 * expected.normal) << "seed 121, round " << round;
    EXPECT_NEAR(found.uv, expected.uv, 1e-12 * expected.uv) << "seed 121, round " << round;
    EXPECT_GT(expected.normal, 0.0);
  }
}

// The series below and above 60 degrees, where the chord is 1.
TEST(AttributeOracle, AnyAngleComesOutOfItsChord) {
  test::RandomSource random(122);
  const ShadedSurface source = flat_source(random, 1, 1.0);
  ShadedSurface flat = source;
  for (std::size_t v = 0; v < 4; ++v) {
    for (std::size_t j = 0; j < 3; ++j) flat.attributes[v * kStride + j] = j == 1 ? 1.0F : 0.0F;
  }
  for (double degrees = 0.001; degrees < 180.0; degrees = degrees * 1.07 + 0.01) {
    ShadedSurface group = flat;
    const double radians = degrees * 0.017453292519943295;
    for (std::size_t v = 0; v < 4; ++v) {
      group.attributes[v * kStride] = static_cast<float>(std::sin(radians));
      group.attributes[v * kStride + 1] = static_cast<float>(std::cos(radians));
    }
    const AttributeDeviation found = measured(flat, group), expected = expected_deviation(flat, group);
    // The smaller of what a series of 24 terms and a chord of doubles lose.
    EXPECT_NEAR(found.normal, expected.normal, 1e-11 * expected.normal + 1e-7 * (degrees > 179.0 ? 1.0 : 0.0));
    EXPECT_NEAR(found.uv, 0.0, 1e-15);
  }
}

/// Beyond the source's border the nearest of its points is on an edge or a corner: attributes are those there.
TEST(AttributeOracle, BeyondTheBorderItsEdgesAnswer) {
  ShadedSurface source;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  source.triangles = {{0, 2, 1}};
  for (const Vec3d& p : source.positions) {
    for (const double value : {0.0, 1.0, 0.0, p.x, p.z, 0.0, 0.0})
      source.attributes.push_back(static_cast<float>(value));
  }
  struct Case {
    Vec3d at;
    double u, v;  // of the nearest point
  };
  for (const Case& one :
       {Case{{0.25, 0.5, -0.5}, 0.25, 0.0}, Case{{-0.5, -0.25, 0.75}, 0.0, 0.75}, Case{{-0.5, 0.0, -0.5}, 0.0, 0.0},
        Case{{3.0, 0.0, -1.0}, 1.0, 0.0}, Case{{-1.0, 0.0, 4.0}, 0.0, 1.0}, Case{{1.0, 0.0, 1.0}, 0.5, 0.5},
        Case{{0.25, 1.0, 0.5}, 0.25, 0.5}}) {
    ShadedSurface group;
    group.triangles = {{0, 1, 2}};
    for (const Vec3d& off : {Vec3d(0.0), Vec3d(1e-9, 0.0, 0.0), Vec3d(0.0, 1e-9, 0.0)}) {
      group.positions.push_back(one.at + off);
      for (const double value : {0.0, 1.0, 0.0, one.u, one.v, 0.0, 0.0})
        group.attributes.push_back(static_cast<float>(value));
    }
    EXPECT_NEAR(measured(source, group).uv, 0.0, 1e-8) << one.at.x << ", " << one.at.z;
  }
}

// Of 20 triangles of one area each 19 are 95%: what these do not exceed, and not the next.
TEST(AttributeOracle, TheQuantileIsMetAtItsPoint) {
  ShadedSurface source, group;
  source.positions = {{-100, 0, -100}, {300, 0, -100}, {-100, 0, 300}};
  source.triangles = {{0, 2, 1}};
  source.attributes.assign(3 * kStride, 0.0F);
  for (std::uint32_t t = 0; t < 20; ++t) {
    for (const Vec3d& p : {Vec3d(t, 0, 0), Vec3d(t + 1.0, 0, 0), Vec3d(t, 0, 1)}) {
      group.positions.push_back(p);
      for (std::size_t j = 0; j < kStride; ++j)
        group.attributes.push_back(j == 3 ? 1.0F + static_cast<float>(t) : 0.0F);
    }
    group.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  EXPECT_NEAR(measured(source, group).uv, 19.0, 1e-9);
}

/// As many points of each triangle as its area asks for, to one, and evenly within it.
TEST(AttributeOracle, PointsAreSpreadByArea) {
  test::RandomSource random(123);
  std::vector<SurfacePart> parts;
  double total = 0.0;
  for (std::uint32_t t = 0; t < 300; ++t) {
    parts.push_back({t, kNoId, t % 7 == 3 ? 0.0 : random.log_between(1e-3, 1.0)});
    total += parts.back().area;
  }
  const std::vector<SurfacePart> points = spread_points(parts, kPointsForUvs);
  ASSERT_EQ(points.size(), kPointsForUvs);
  std::vector<double> count(parts.size(), 0.0);
  for (const SurfacePart& point : points) ++count[point.triangle];
  for (std::size_t t = 0; t < parts.size(); ++t) {
    EXPECT_NEAR(count[t], parts[t].area / total * kPointsForUvs, parts[t].area > 0.0 ? 1.0 + 1e-9 : 0.0);
  }
  // Sixteen equal parts of a triangle.
  std::array<std::size_t, 16> within{};
  for (const SurfacePart& point : points) {
    const std::array<double, 3> w = shares_of(point.number);
    EXPECT_NEAR(w[0] + w[1] + w[2], 1.0, 1e-15);
    const auto i = static_cast<std::size_t>(4.0 * w[1]), j = static_cast<std::size_t>(4.0 * w[2]);
    const bool is_turned = 4.0 * (w[1] + w[2]) - static_cast<double>(i + j) > 1.0;
    ++within[std::min<std::size_t>(15, i * 8 - i * i + 2 * j + (is_turned ? 1 : 0))];  // the first is on the border
  }
  for (const std::size_t n : within) EXPECT_NEAR(static_cast<double>(n), kPointsForUvs / 16.0, 6.0);
}

// Where the source has no area there, its first corner answers.
TEST(AttributeOracle, ASourceWithoutAreaHasTheAttributesOfACorner) {
  ShadedSurface source, group;
  source.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  source.triangles = {{0, 1, 2}};
  source.attributes.assign(3 * kStride, 3.0F);
  group.positions = {{0.5, 0, 1}, {1.0, 0, 1}, {0.5, 1, 1}};
  group.triangles = {{0, 1, 2}};
  group.attributes.assign(3 * kStride, 3.0F);
  EXPECT_NEAR(measured(source, group).uv, 0.0, 1e-12);
}

}  // namespace
}  // namespace meshlode::builder
