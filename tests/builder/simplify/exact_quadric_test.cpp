// SPDX-License-Identifier: GPL-3.0-or-later
// Quadrics against their definition. Of small whole numbers every product and sum is exact, in doubles and in floats,
// so that nothing but equality will do.
#include "builder/simplify/quadric.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "builder/simplify/placement.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

template <class Real>
using VecOf = glm::vec<3, Real>;
using Vec3l = glm::vec<3, long double>;

Vec3d whole_vector(test::RandomSource& random, std::uint32_t most) {
  const auto one = [&] { return static_cast<double>(random.below(2 * most + 1)) - most; };
  const double x = one(), y = one(), z = one();
  return {x, y, z};
}

struct WeightedPlane {
  Vec3d n;
  double d, w;
  [[nodiscard]] double error(const Vec3d& p) const {
    const double off = glm::dot(n, p) + d;
    return w * off * off;
  }
};

template <class Real>
void expect_sums_of_planes(std::uint64_t seed) {
  test::RandomSource random(seed);
  const auto draw_plane = [&] {
    const Vec3d n = whole_vector(random, 3);
    return WeightedPlane{n, static_cast<double>(random.below(9)) - 4.0, 1.0 + random.below(3)};
  };
  for (int round = 0; round < 500; ++round) {
    BasicQuadric<Real> one, other;
    std::vector<WeightedPlane> planes(1 + random.below(3)), more(1 + random.below(3));
    double weight = 0.0;
    for (WeightedPlane& plane : planes) {
      plane = draw_plane();
      one.add_plane(VecOf<Real>(plane.n), static_cast<Real>(plane.d), static_cast<Real>(plane.w));
      weight += plane.w;
    }
    for (WeightedPlane& plane : more) {
      plane = draw_plane();
      other.add_plane(VecOf<Real>(plane.n), static_cast<Real>(plane.d), static_cast<Real>(plane.w));
    }
    EXPECT_EQ(one.weight, weight);
    const Vec3d center = whole_vector(random, 3);
    BasicQuadric<Real> with_point = one, scaled = one, joined = one;
    with_point.add_point(VecOf<Real>(center), Real(3));
    scaled.add_scaled(other, Real(2));
    joined += other;
    EXPECT_EQ(with_point.weight, weight) << "a pull has no area";
    EXPECT_EQ(scaled.weight, weight);
    EXPECT_EQ(joined.weight, one.weight + other.weight);
    for (int k = 0; k < 8; ++k) {
      const Vec3d p = whole_vector(random, 5);
      double error = 0.0, error_more = 0.0;
      for (const WeightedPlane& plane : planes) error += plane.error(p);
      for (const WeightedPlane& plane : more) error_more += plane.error(p);
      const VecOf<Real> at(p);
      ASSERT_EQ(one.evaluate(at), error) << "seed " << seed << ", round " << round;
      ASSERT_EQ(with_point.evaluate(at), error + 3.0 * glm::dot(p - center, p - center));
      ASSERT_EQ(scaled.evaluate(at), error + 2.0 * error_more);
      ASSERT_EQ(joined.evaluate(at), error + error_more);
    }
  }
}

TEST(ExactQuadric, IsTheSumOfItsSquaredDistances) {
  expect_sums_of_planes<double>(101);
  expect_sums_of_planes<float>(102);
}

TEST(ExactQuadric, ErrorsAreToldHoweverSmallAndNeverBelowZero) {
  Quadric q;
  q.add_plane({1, 0, 0}, 0.0, 1.0);
  EXPECT_EQ(q.evaluate({0x1p-200, 5.0, 7.0}), 0x1p-400);
  q.b2_c[1] = -1.0;
  EXPECT_EQ(q.evaluate(Vec3d(0.5)), 0.0);
  q.b2_c[1] = -0.25;
  EXPECT_EQ(q.evaluate(Vec3d(0.5)), 0.0);
}

/// The residual of A p = -b, over what the entries of its rows add up to.
template <class Real>
long double relative_residual(const BasicQuadric<Real>& q, const VecOf<Real>& p) {
  using L = long double;
  const L x = p.x, y = p.y, z = p.z;
  const std::array<std::array<L, 4>, 3> rows{{{q.a00() * x, q.a01() * y, q.a02() * z, q.b0()},
                                              {q.a01() * x, q.a11() * y, q.a12() * z, q.b1()},
                                              {q.a02() * x, q.a12() * y, q.a22() * z, q.b2()}}};
  L worst = 0.0L;
  for (const auto& row : rows) {
    L sum = 0.0L, size = 0.0L;
    for (const L term : row) {
      sum += term;
      size += std::fabs(term);
    }
    if (size > 0.0L) worst = std::max(worst, std::fabs(sum) / size);
  }
  return worst;
}

template <class Real>
void expect_minima(std::uint64_t seed, long double allowed) {
  test::RandomSource random(seed);
  int solved = 0;
  for (int round = 0; round < 500; ++round) {
    BasicQuadric<Real> q;
    for (int k = 0; k < 4; ++k) q.add_plane(VecOf<Real>(whole_vector(random, 4)), Real(random.below(9)) - 4, Real(1));
    VecOf<Real> p;
    if (!q.minimize(p)) continue;
    ++solved;
    ASSERT_LE(relative_residual(q, p), allowed) << "seed " << seed << ", round " << round;
  }
  EXPECT_GT(solved, 400);
}

TEST(ExactQuadric, TheMinimumSolvesItsSystem) {
  expect_minima<double>(103, 1e-13L);
  expect_minima<float>(104, 1e-5L);
}

/// A diagonal system that is as ill-conditioned as said, in any order of axes.
template <class Real>
bool has_minimum(const std::array<double, 3>& diagonal) {
  BasicQuadric<Real> q;
  q.a00_a01[0] = static_cast<Real>(diagonal[0]);
  q.a11_a12[0] = static_cast<Real>(diagonal[1]);
  q.b1_a22[1] = static_cast<Real>(diagonal[2]);
  VecOf<Real> p;
  return q.minimize(p);
}

// A pivot is trusted above 1e-12 of the largest entry (1e-3 in floats), whichever axis it is of and at any scale.
TEST(ExactQuadric, APivotOfTwelveLostDigitsIsNotTrusted) {
  for (const double scale : {1e-30, 1.0, 1e30}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t largest = 0; largest < 3; ++largest) {
        if (axis == largest) continue;
        std::array<double, 3> diagonal{0.5 * scale, 0.5 * scale, 0.5 * scale};
        diagonal[largest] = scale;
        diagonal[axis] = 1.01e-12 * scale;
        EXPECT_TRUE(has_minimum<double>(diagonal)) << axis << largest;
        diagonal[axis] = 1e-12 * scale;
        EXPECT_FALSE(has_minimum<double>(diagonal)) << "not above it: " << axis << largest;
        diagonal[axis] = 1.01e-3 * scale;
        EXPECT_TRUE(has_minimum<float>(diagonal)) << axis << largest;
        diagonal[axis] = 0.99e-3 * scale;
        EXPECT_FALSE(has_minimum<float>(diagonal)) << axis << largest;
      }
    }
  }
  EXPECT_FALSE(has_minimum<double>({0.0, 0.0, 0.0}));
  EXPECT_FALSE(has_minimum<double>({-1.0, -1.0, -1.0}));
  EXPECT_TRUE(has_minimum<double>({1e-300, 1e-300, 1e-300}));
}

TEST(ExactQuadric, AMinimumThatIsNotFiniteIsNone) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Quadric q;
    q.a00_a01[0] = q.a11_a12[0] = q.b1_a22[1] = 1e-200;
    q.a02_b0[1] = axis == 0 ? 1e200 : 0.0;
    q.b1_a22[0] = axis == 1 ? 1e200 : 0.0;
    q.b2_c[0] = axis == 2 ? 1e200 : 0.0;
    Vec3d p;
    EXPECT_FALSE(q.minimize(p)) << axis;
  }
}

/// Faces on each of which every attribute is linear: the error of given values is what the definition adds up to.
struct LinearFace {
  double weight;
  std::array<Vec3d, 2> slope;
  std::array<double, 2> offset;
};

/// What of a wedge's error depends on its values, and what on the place alone.
template <class Real>
struct Wedge {
  WedgeQuadric<Real, 3> values;
  BasicQuadric<Real> base;

  void add_face(std::size_t j, const Vec3d& slope, double offset, double weight) {
    const Linear<Real> value(VecOf<Real>(slope), static_cast<Real>(offset));
    base.add_square(value, static_cast<Real>(weight));
    values.sum[j] += value.scaled(static_cast<Real>(weight));
  }
  void add(const Wedge& other) {
    values.add(other.values, 2);
    base += other.base;
  }
  [[nodiscard]] double error(const VecOf<Real>& p, const double* of, std::size_t count) const {
    return double{base.evaluate(p)} + double{values.evaluate(p, of, count)};
  }
};

template <class Real>
Wedge<Real> wedge_of(const std::vector<LinearFace>& faces) {
  Wedge<Real> wedge;
  for (const LinearFace& face : faces) {
    Wedge<Real> own;
    own.values.weight = static_cast<Real>(face.weight);
    for (std::size_t j = 0; j < 2; ++j) own.add_face(j, face.slope[j], face.offset[j], face.weight);
    wedge.add(own);
  }
  EXPECT_EQ(wedge.base.weight, 0) << "attributes have no area";
  return wedge;
}

double error_of_values(const std::vector<LinearFace>& faces, const Vec3d& p, const double* values) {
  double error = 0.0;
  for (const LinearFace& face : faces) {
    for (std::size_t j = 0; j < 2; ++j) {
      const double off = glm::dot(face.slope[j], p) + face.offset[j] - values[j];
      error += face.weight * off * off;
    }
  }
  return error;
}

template <class Real>
void expect_wedge_sums(std::uint64_t seed) {
  test::RandomSource random(seed);
  const auto draw = [&](std::size_t count) {
    std::vector<LinearFace> faces(count);
    double weight = 0.0;
    for (LinearFace& face : faces) {
      face.weight = 1.0 + random.below(2);
      weight += face.weight;
      for (std::size_t j = 0; j < 2; ++j) {
        face.slope[j] = whole_vector(random, 2);
        face.offset[j] = static_cast<double>(random.below(7)) - 3.0;
      }
    }
    // Summed weights are powers of two: then the best values, a quotient, are exact as well.
    faces[0].weight += 8.0 - weight;
    return faces;
  };
  for (int round = 0; round < 300; ++round) {
    std::vector<LinearFace> faces = draw(1 + random.below(3));
    const std::vector<LinearFace> more = draw(1 + random.below(3));
    Wedge<Real> joined = wedge_of<Real>(faces);
    joined.add(wedge_of<Real>(more));
    faces.insert(faces.end(), more.begin(), more.end());
    EXPECT_EQ(joined.values.weight, 16);
    BasicQuadric<Real> reduced = joined.base;
    reduced.add_point(VecOf<Real>(1), Real(2));
    joined.values.add_best_to(reduced, 2);
    EXPECT_EQ(reduced.weight, 0) << "attributes have no area";
    for (int k = 0; k < 6; ++k) {
      const Vec3d p = whole_vector(random, 4);
      const VecOf<Real> at(p);
      const std::array<double, 2> values{static_cast<double>(random.below(7)) - 3.0, 1.0 * random.below(4)};
      const double error = error_of_values(faces, p, values.data());
      ASSERT_EQ(joined.error(at, values.data(), 2), error) << "seed " << seed << ", round " << round;
      std::array<double, 2> best{};
      for (std::size_t j = 0; j < 2; ++j) {
        for (const LinearFace& face : faces) best[j] += face.weight * (glm::dot(face.slope[j], p) + face.offset[j]);
        best[j] /= 16.0;
        ASSERT_EQ(joined.values.best(j, at), best[j]);
      }
      ASSERT_EQ(reduced.evaluate(at),
                error_of_values(faces, p, best.data()) + 2.0 * glm::dot(p - Vec3d(1), p - Vec3d(1)))
          << "seed " << seed << ", round " << round;
    }
  }
}

TEST(ExactQuadric, AWedgeCostsWhatItsValuesAreOffOnEachFace) {
  expect_wedge_sums<double>(105);
  expect_wedge_sums<float>(106);
}

TEST(ExactQuadric, AWedgeOfNoFaceCostsNothingAndOfATinyOneItsShare) {
  const WedgeQuadric<double, 3> none;
  Quadric total;
  none.add_best_to(total, 2);
  EXPECT_EQ(total.evaluate(Vec3d(1.0)), 0.0) << "and not what is no number";
  Wedge<double> tiny;
  for (const double value : {1.0, -1.0}) {
    tiny.values.weight += 0x1p-60;
    tiny.add_face(0, Vec3d(0.0), value, 0x1p-60);
  }
  total = tiny.base;
  tiny.values.add_best_to(total, 1);
  EXPECT_EQ(total.evaluate(Vec3d(0.0)), 0x1p-59) << "the mean is 0, and both are 1 off";
  const double value = 1.0;
  EXPECT_EQ(tiny.error(Vec3d(0.0), &value, 1), 0x1p-58);
}

// The best of the three candidates: the stationary point along the edge, held to it, and its ends.
TEST(Placement, NoPointOfTheEdgeIsCheaperThanTheFallback) {
  test::RandomSource random(107);
  int of_rounding_alone = 0;
  for (int round = 0; round < 500; ++round) {
    const Vec3d a = random.in_cube(1.0), b = random.in_cube(1.0);
    Quadric q;
    // One plane or two, and no weight: nothing pulls, and the system has no minimum. Elimination without pivoting takes
    // the rounding of a second pivot that nearly vanishes for a third in 0.15% of the pairs: those are not this law's.
    const std::uint32_t planes = 1 + random.below(2);
    for (std::uint32_t k = 0; k < planes; ++k) {
      const Vec3d normal = random.direction();
      const double offset = random.between(-1.5, 1.5);
      q.add_plane(normal, offset, random.log_between(1e-3, 1e3));
    }
    q.weight = 0.0;
    Vec3d of_rounding;
    if (q.minimize(of_rounding)) {
      ASSERT_EQ(planes, 2u) << "one plane leaves nothing to divide by";
      ++of_rounding_alone;
      continue;
    }
    const Quadric of_edge = q;
    const Vec3d place = place_vertex(q, a, b);
    long double least = std::numeric_limits<long double>::infinity();
    const auto error_at = [&](const Vec3l& p) {
      const Vec3l r(of_edge.a00() * p.x + of_edge.a01() * p.y + of_edge.a02() * p.z,
                    of_edge.a01() * p.x + of_edge.a11() * p.y + of_edge.a12() * p.z,
                    of_edge.a02() * p.x + of_edge.a12() * p.y + of_edge.a22() * p.z);
      return glm::dot(p, r) + 2.0L * glm::dot(Vec3l(of_edge.b0(), of_edge.b1(), of_edge.b2()), p) + of_edge.c();
    };
    constexpr int kSteps = 512;
    for (int i = 0; i <= kSteps; ++i) {
      least = std::min(least, error_at(Vec3l(a) + Vec3l(b - a) * (static_cast<long double>(i) / kSteps)));
    }
    const double size = q.a00() + q.a11() + q.a22() + std::fabs(q.c());
    ASSERT_LE(error_at(Vec3l(place)), least + 1e-14L * size) << "seed 107, round " << round;
    const double along = glm::dot(place - a, b - a) / glm::dot(b - a, b - a);
    ASSERT_GE(along, -1e-12);
    ASSERT_LE(along, 1.0 + 1e-12);
    ASSERT_LE(glm::length(a + (b - a) * along - place), 1e-12) << "on the edge";
  }
  EXPECT_LE(of_rounding_alone, 5);
}

// A minimum 1.5 edges from the middle is taken, and one beyond is not, along any axis and at any scale.
TEST(Placement, MinimaAreTakenWithinOneAndAHalfEdges) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d a(0.0), b(0.0);
      a[axis] = -scale;
      b[axis] = scale;
      for (const double share : {1.4999, 1.5001}) {
        Vec3d corner(0.0);
        corner[(axis + 1) % 3] = 2.0 * share * scale;
        Quadric q;
        for (int k = 0; k < 3; ++k) {
          Vec3d n(0.0);
          n[k] = 1.0;
          q.add_plane(n, -corner[k], 1.0);
        }
        const Vec3d place = place_vertex(q, a, b);
        EXPECT_NEAR(glm::length(place - (share < 1.5 ? corner : Vec3d(0.0))), 0.0, 1e-5 * scale) << axis << share;
      }
    }
  }
}

// Of a flat surface alone the pull is all that acts along it: its size shows against a wall of known weight.
TEST(Placement, ThePullIsAMillionthOfTheArea) {
  Quadric q;
  q.add_plane({0, 0, 1}, 0.0, 4.0);
  // A wall at x = 1 that weighs 3 millionths, without area; the middle of the edge is at 0 and pulls with 4.
  Quadric wall;
  wall.add_plane({1, 0, 0}, -1.0, 3e-6);
  q.add_scaled(wall, 1.0);
  const Vec3d place = place_vertex(q, Vec3d(-1, 0, 0), Vec3d(1, 0, 0));
  EXPECT_NEAR(place.x, 3.0 / 7.0, 1e-9);
  EXPECT_NEAR(q.evaluate(place), 3e-6 * 16.0 / 49.0 + 4e-6 * 9.0 / 49.0, 1e-15) << "and is part of what it costs";
}

}  // namespace
}  // namespace meshlode::builder
