// SPDX-License-Identifier: GPL-3.0-or-later
// The bounds of docs/explanation/numerics.md on distances, against 113 bits of mantissa.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "builder/deviation/deviation.h"
#include "builder/deviation/point_distance.h"
#include "hard/share.h"
#include "support/random.h"

namespace meshlode::test::hard {
namespace {

using builder::TriangleCorners;
using Quad = boost::multiprecision::cpp_bin_float_quad;

constexpr double kDouble = 0x1p-53;

struct Vec3q {
  Quad x, y, z;
  explicit Vec3q(const Vec3d& v) : x(v.x), y(v.y), z(v.z) {}
  Vec3q(const Quad& a, const Quad& b, const Quad& c) : x(a), y(b), z(c) {}
  Vec3q operator-(const Vec3q& v) const { return {x - v.x, y - v.y, z - v.z}; }
  Vec3q operator*(const Quad& f) const { return {x * f, y * f, z * f}; }
};

Quad dot(const Vec3q& a, const Vec3q& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec3q cross(const Vec3q& a, const Vec3q& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Quad segment_distance2(const Vec3q& p, const Vec3q& a, const Vec3q& b) {
  const Vec3q edge = b - a, pa = p - a;
  const Quad length2 = dot(edge, edge);
  Quad t = length2 > 0 ? dot(pa, edge) / length2 : Quad(0);
  t = std::min(std::max(t, Quad(0)), Quad(1));
  const Vec3q away = pa - edge * t;
  return dot(away, away);
}

/// Point to triangle, all corners taken at their word.
Quad true_distance(const Vec3d& point, const TriangleCorners& corners) {
  const Vec3q p(point), a(corners[0]), b(corners[1]), c(corners[2]);
  const Vec3q ab = b - a, ac = c - a, pa = p - a, n = cross(ab, ac);
  const Quad nn = dot(n, n);
  if (nn > 0) {
    const Quad v = dot(cross(pa, ac), n) / nn, w = dot(cross(ab, pa), n) / nn;
    if (v >= 0 && w >= 0 && v + w <= 1) return abs(dot(pa, n)) / sqrt(nn);
  }
  return sqrt(std::min(segment_distance2(p, a, b), std::min(segment_distance2(p, b, c), segment_distance2(p, a, c))));
}

double longest_edge(const TriangleCorners& t) {
  return std::max(glm::length(t[1] - t[0]), std::max(glm::length(t[2] - t[1]), glm::length(t[0] - t[2])));
}

TEST(Numerics, ADistanceToATriangleIsTooSmallByLessThanItsAllowance) {
  RandomSource random(75);
  Worst worst;
  for (int round = 0; round < 60000; ++round) {
    // Two edges that meet at a sine down to 2^-24, and a point near one corner, or over the plane by next to nothing.
    const double sine = std::ldexp(1.0, -static_cast<int>(random.below(25)));
    const Vec3d far = random.in_cube(round % 3 == 0 ? 1000.0 : 0.0);
    TriangleCorners t{random.in_cube(1.0), random.in_cube(1.0), random.in_cube(1.0)};
    const std::uint32_t k = random.below(3);
    const double along = random.between(0.0, 1.0);
    t[k] = t[(k + 1) % 3] * along + t[(k + 2) % 3] * (1.0 - along) + random.in_cube(sine);
    for (Vec3d& corner : t) corner += far;
    const std::uint32_t at = random.below(3);
    const double reach = std::ldexp(random.between(-1.0, 1.0), -static_cast<int>(random.below(40)));
    const double side = std::ldexp(random.between(-1.0, 1.0), -static_cast<int>(random.below(40)));
    Vec3d p = t[at] + (t[at] - t[(at + 1) % 3]) * reach + (t[at] - t[(at + 2) % 3]) * side;
    p += random.direction() * std::ldexp(1.0, -static_cast<int>(random.below(60)));
    const double found = std::sqrt(builder::point_triangle_distance2(p, t));
    const Quad allowance = 8 * Quad(kDouble) * found + 9 * Quad(kDouble) * longest_edge(t);
    worst.take(((true_distance(p, t) - found) / allowance).convert_to<double>(), round);
  }
  expect_kept("distance to a triangle", worst, 0.05);
}

struct Patch {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  [[nodiscard]] builder::GroupSurface as_group() const { return {positions, triangles}; }
  [[nodiscard]] TriangleCorners corners(const std::array<std::uint32_t, 3>& t) const {
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
  }
};

/// Where a patch lies: its sides and the direction of its heights.
struct Frame {
  Vec3d offset, along, across, up;
};

Frame random_frame(RandomSource& random, double width, double offset) {
  const Vec3d along = random.direction(), up = glm::normalize(glm::cross(along, random.direction()));
  return {random.in_cube(offset), along, glm::cross(up, along) * width, up};
}

/// A height field of `side` squares a side.
Patch bumpy_patch(RandomSource& random, std::uint32_t side, double height, const Frame& frame) {
  Patch patch;
  for (std::uint32_t i = 0; i <= side; ++i) {
    for (std::uint32_t j = 0; j <= side; ++j) {
      patch.positions.push_back(frame.offset + frame.along * (static_cast<double>(i) / side) +
                                frame.across * (static_cast<double>(j) / side) +
                                frame.up * (height * random.between(-1.0, 1.0)));
    }
  }
  for (std::uint32_t i = 0; i < side; ++i) {
    for (std::uint32_t j = 0; j < side; ++j) {
      const std::uint32_t a = i * (side + 1) + j, b = a + side + 1;
      patch.triangles.push_back({a, b, a + 1});
      patch.triangles.push_back({a + 1, b, b + 1});
    }
  }
  return patch;
}

/// The largest distance of points of one patch to the other: corners, and points between them on a grid of eighths.
Quad farthest(const Patch& from, const Patch& to) {
  Quad largest = 0;
  for (const auto& t : from.triangles) {
    const TriangleCorners c = from.corners(t);
    for (int i = 0; i <= 8; i += 2) {
      for (int j = 0; i + j <= 8; j += 2) {
        const Vec3d p = c[0] * (i / 8.0) + c[1] * (j / 8.0) + c[2] * ((8 - i - j) / 8.0);
        Quad nearest = true_distance(p, to.corners(to.triangles[0]));
        for (const auto& u : to.triangles) nearest = std::min(nearest, true_distance(p, to.corners(u)));
        largest = std::max(largest, nearest);
      }
    }
  }
  return largest;
}

TEST(Numerics, ACertifiedDeviationIsNoSmallerThanAnyDistanceOfPoints) {
  RandomSource random(76);
  Worst usual, flat;
  for (int round = 0; round < 24; ++round) {
    // Rows down to needles of 2^-20; every third pair is flat, so that its bound is nothing but the allowance for
    // rounding.
    const bool is_flat = round % 3 == 0;
    const double width = std::ldexp(1.0, -static_cast<int>(random.below(21)));
    const Frame frame = random_frame(random, width, round % 2 == 0 ? 0.0 : 100.0);
    const double height = is_flat ? 0.0 : random.log_between(1e-6, 0.3);
    const Patch fine = bumpy_patch(random, 4, height, frame), coarse = bumpy_patch(random, 2, height, frame);
    const std::vector<builder::TriangleBound> none(fine.triangles.size());
    const builder::CertifiedGroup certified = builder::certify_group(fine.as_group(), none, coarse.as_group());
    const Quad truth = std::max(farthest(fine, coarse), farthest(coarse, fine));
    (is_flat ? flat : usual).take((truth / Quad(certified.deviation)).convert_to<double>(), round);
  }
  expect_kept("certified deviation", usual, 0.9);
  // Points between corners are rounded here too: what is used is a few of the 1,024 units that are allowed.
  expect_kept("certified deviation, flat", flat, 1e-5);
}

}  // namespace
}  // namespace meshlode::test::hard
