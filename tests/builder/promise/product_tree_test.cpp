// SPDX-License-Identifier: GPL-3.0-or-later
// Nearest triangles of the product space, against points of the triangle and against looking at all of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"
#include "builder/promise/product_tree.h"

namespace meshlode::builder {
namespace {

using ProductPoint8 = ProductPoint<8>;

ProductPoint8 random_product_point(SplitMix64& random, double size) {
  ProductPoint8 p;
  for (double& x : p) x = size * random.signed_unit();
  return p;
}

double product_apart2(const ProductPoint8& a, const ProductPoint8& b) {
  double sum = 0.0;
  for (std::size_t d = 0; d < a.size(); ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

/// Least over a fine lattice of the triangle: from above, and near.
double product_lattice2(const ProductPoint8& q, const ProductSurface<8>& one) {
  constexpr int kSteps = 200;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      best = std::min(best, product_apart2(q, one.at(0, double(i) / kSteps, double(j) / kSteps)));
    }
  }
  return best;
}

TEST(ProductTree, TheNearestPointOfATriangleIsThatOfALattice) {
  SplitMix64 random(7);
  int dismissed = 0;  // by their planes
  for (int i = 0; i < 200; ++i) {
    ProductSurface<8> one;
    for (int k = 0; k < 3; ++k) one.points.push_back(random_product_point(random, 1.0));
    if (i % 4 == 1) one.points[2] = one.points[1];  // an edge
    one.triangles.push_back({0, 1, 2});
    if (i % 4 == 2) {  // three corners in a line
      for (std::size_t d = 0; d < 8; ++d) one.points[2][d] = 0.3 * one.points[0][d] + 0.7 * one.points[1][d];
    }
    if (i % 4 == 3) {  // a needle, far away
      for (std::size_t d = 0; d < 8; ++d) one.points[2][d] = one.points[1][d] + 0.02 * one.points[2][d];
    }
    const ProductPoint8 q = random_product_point(random, i % 2 == 0 ? 0.5 : 3.0);
    const double found = std::sqrt(product_distance2<8>(q, one.points[0], one.points[1], one.points[2]));
    const double lattice = std::sqrt(product_lattice2(q, one));
    EXPECT_LE(found, lattice * (1.0 + 1e-12)) << i;
    EXPECT_GE(found, lattice - 0.03) << i;  // no farther than the lattice is fine
    const auto distance2_within = [&](double share) {
      return product_distance2<8>(q, one.points[0], one.points[1], one.points[2], share * found * found);
    };
    EXPECT_EQ(distance2_within(1.0 + 1e-12), distance2_within(std::numeric_limits<double>::infinity())) << i;
    if (i % 4 == 0 && std::isinf(distance2_within(0.5))) ++dismissed;
  }
  EXPECT_GT(dismissed, 10);
}

/// Of random triangles, one in four of them a needle, and points near and far.
template <std::size_t D>
void expect_all_looked_at(double stretch) {
  SplitMix64 random(11);
  const auto random_point = [&](double size) {
    ProductPoint<D> p;
    for (double& x : p) x = size * random.signed_unit();
    return p;
  };
  ProductSurface<D> surface;
  for (std::uint32_t t = 0; t < 500; ++t) {
    const ProductPoint<D> center = random_point(1.0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      ProductPoint<D> p = random_point(t % 4 == 0 && k == 2 ? 1e-4 : 0.1);
      for (std::size_t d = 0; d < D; ++d) p[d] += t % 4 == 0 && k == 2 ? surface.points.back()[d] : center[d];
      if (k < 2 || t % 4 != 0) p[3] *= stretch;  // coordinates of a texture, in other units than positions
      surface.points.push_back(p);
    }
    surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const ProductTree<D> tree(surface);
  for (int i = 0; i < 300; ++i) {
    ProductPoint<D> q = random_point(i % 10 == 0 ? 1e25 : 1.5);
    q[3] *= stretch;
    double best = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : surface.triangles) {
      best = std::min(best, product_distance2<D>(q, surface.points[a], surface.points[b], surface.points[c]));
    }
    const std::uint32_t hint = i % 2 == 0 ? kNoId : static_cast<std::uint32_t>(random.below(500));
    const double found = tree.find(q, hint, 0.0).distance2;
    if (i % 10 == 0) {
      EXPECT_NEAR(found / best, 1.0, 1e-12) << D << " " << i << ": as near as any";
    } else {
      EXPECT_EQ(found, best) << D << " " << i;
    }
    const auto near = tree.find(q, hint, 4.0 * best);
    EXPECT_LE(near.distance2, 4.0 * best) << "near enough is near enough";
  }
}

TEST(ProductTree, ItFindsWhatLookingAtAllFinds) {
  for (const double stretch : {1.0, 1e-3, 1e6}) {
    expect_all_looked_at<5>(stretch);
    expect_all_looked_at<8>(stretch);
    expect_all_looked_at<14>(stretch);
  }
}

TEST(ProductTree, NothingIsNearWhatIsNoNumber) {
  const ProductSurface<8> one{{ProductPoint8{}, ProductPoint8{1.0}, ProductPoint8{0.0, 1.0}}, {{0, 1, 2}}};
  ProductPoint8 q{};
  q[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ProductTree<8>(one).find(q, 0, 0.0).triangle, kNoId);
}

TEST(ProductTree, OfSomeTrianglesTheOthersAreNotFound) {
  SplitMix64 random(12);
  ProductSurface<8> surface;
  std::vector<std::uint32_t> some;
  for (std::uint32_t t = 0; t < 60; ++t) {
    for (int k = 0; k < 3; ++k) surface.points.push_back(random_product_point(random, 1.0));
    surface.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    if (t % 3 != 0) some.push_back(t);
  }
  const ProductTree<8> tree(surface, some);
  for (int i = 0; i < 200; ++i) {
    const ProductPoint8 q = random_product_point(random, 1.5);
    double best = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : some) {
      const auto& [a, b, c] = surface.triangles[t];
      best = std::min(best, product_distance2<8>(q, surface.points[a], surface.points[b], surface.points[c]));
    }
    const auto hit = tree.find(q, i % 2 == 0 ? kNoId : some[random.below(some.size())], 0.0);
    EXPECT_EQ(hit.distance2, best) << i;
    EXPECT_NE(hit.triangle % 3, 0U) << i;
  }
}

TEST(ProductTree, OfNothingNothingIsFound) {
  const ProductSurface<8> nothing;
  EXPECT_EQ(ProductTree<8>(nothing).find({}, kNoId, 0.0).triangle, kNoId);
}

}  // namespace
}  // namespace meshlode::builder
