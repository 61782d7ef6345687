// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle laid over a surface: what is said to be within is, and what is found to be far is as far as it says.
#include "builder/measure/overlay.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode::builder {
namespace {

using Triangle = LinkedSurface::Triangle;

/// A surface with all that laying over it takes.
struct Sheet {
  std::vector<Vec3d> positions;
  std::vector<Triangle> triangles, neighbor;
  std::vector<Vec3f> normal;
  SurfaceTree tree;
  std::vector<TreeSlot> slot;

  void link() {
    neighbor = link_edges(triangles, positions.size(), [](std::uint32_t corner) { return corner; });
    for (const Triangle& t : triangles) {
      const Vec3d n = glm::cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
      normal.push_back(glm::length(n) > 0.0 ? Vec3f(glm::normalize(n)) : Vec3f(0.0F));
    }
    tree.build({positions, triangles});
    slot.resize(triangles.size());
    for (std::uint32_t i = 0; i < triangles.size(); ++i) slot[tree.triangle_at(TreeSlot(i))] = TreeSlot(i);
  }
  [[nodiscard]] LinkedSurface linked() const { return {positions, triangles, neighbor, normal, tree, slot}; }
  [[nodiscard]] double distance_to(const Vec3d& p) const {
    double least2 = std::numeric_limits<double>::infinity();
    for (const Triangle& t : triangles) {
      least2 = std::min(least2, point_triangle_distance2(p, {positions[t[0]], positions[t[1]], positions[t[2]]}));
    }
    return std::sqrt(least2);
  }
};

/// A lattice of n by n squares over the unit square, with heights.
template <class Height>
Sheet lattice(std::uint32_t n, const Height& height) {
  Sheet sheet;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) {
      const Vec3d at(static_cast<double>(x) / n, static_cast<double>(y) / n, 0.0);
      sheet.positions.emplace_back(at.x, at.y, height(at));
    }
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
      sheet.triangles.push_back({a, b, d});
      sheet.triangles.push_back({a, d, c});
    }
  }
  sheet.link();
  return sheet;
}

/// The largest distance of points spread over a triangle.
double sampled(const Sheet& sheet, const TriangleCorners& t) {
  constexpr int kParts = 24;
  double most = 0.0;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; i + j <= kParts; ++j) {
      most = std::max(
          most, sheet.distance_to(t[0] + (t[1] - t[0]) * (1.0 * i / kParts) + (t[2] - t[0]) * (1.0 * j / kParts)));
    }
  }
  return most;
}

std::uint32_t nearest(const Sheet& sheet, const Vec3d& p) {
  return sheet.tree.triangle_at(sheet.tree.find_nearest(sheet.tree.to_frame(p), {}, 0.0F).slot);
}

/// No point of a triangle is farther than this, as the last call of is_within() says.
double bound_of(const Overlay& overlay, double known) {
  double bound = known;
  for (const Overlay::Far& far : overlay.far()) bound = std::max(bound, far.distance);
  for (const Overlay::Rest& rest : overlay.rest()) bound = std::max(bound, rest.bound);
  return bound;
}

TEST(Overlay, OfAFlatSheetTheHeightIsKnownFromFewCorners) {
  const Sheet sheet = lattice(4, [](const Vec3d&) { return 0.0; });
  const LinkedSurface linked = sheet.linked();
  Overlay overlay(linked, 48, Overlay::Cuts::kAll);
  const TriangleCorners above{Vec3d(0.1, 0.1, 0.01), Vec3d(0.9, 0.2, 0.01), Vec3d(0.4, 0.8, 0.01)};
  EXPECT_TRUE(overlay.is_within(above, nearest(sheet, above[0]), 0.0101));
  EXPECT_GT(overlay.below().size(), 5U);
  EXPECT_FALSE(overlay.is_within(above, nearest(sheet, above[0]), 0.0099));
  ASSERT_FALSE(overlay.far().empty());
  EXPECT_NEAR(overlay.far().front().distance, 0.01, 1e-12);
}

TEST(Overlay, APeakBetweenCornersThatAreNearIsFound) {
  // A valley across the middle; the triangle's corners lie on both sides of it.
  const Sheet sheet = lattice(8, [](const Vec3d& p) { return p.x == 0.5 ? -0.1 : 0.0; });
  const LinkedSurface linked = sheet.linked();
  Overlay overlay(linked, 48, Overlay::Cuts::kAll);
  const TriangleCorners t{Vec3d(0.3, 0.4, 0.0), Vec3d(0.7, 0.45, 0.0), Vec3d(0.45, 0.6, 0.0)};
  EXPECT_FALSE(overlay.is_within(t, nearest(sheet, t[0]), 0.01));
  double most = 0.0;
  for (const Overlay::Far& far : overlay.far()) most = std::max(most, far.distance);
  EXPECT_GE(most, 0.999 * sampled(sheet, t));
}

/// Two valleys, the deeper one first: what it is off by says nothing of what another group made, the other one.
TEST(Overlay, WhatIsKnownMayStayAsItIs) {
  const Sheet sheet = lattice(8, [](const Vec3d& p) { return p.x == 0.25 ? -0.2 : p.x == 0.75 ? -0.05 : 0.0; });
  const LinkedSurface linked = sheet.linked();
  Overlay overlay(linked, 96, Overlay::Cuts::kAll);
  const TriangleCorners t{Vec3d(0.05, 0.4, 0.0), Vec3d(0.95, 0.45, 0.0), Vec3d(0.5, 0.6, 0.0)};
  for (const bool is_raised : {true, false}) {
    EXPECT_FALSE(overlay.is_within(t, nearest(sheet, t[0]), 0.01, is_raised));
    double first = 0.0, second = 0.0;
    for (const Overlay::Far& far : overlay.far()) {
      double& most = far.at.x < 0.5 ? first : second;
      most = std::max(most, far.distance);
    }
    EXPECT_GT(first, 0.05);
    EXPECT_EQ(second > 0.03, !is_raised) << second;
  }
}

TEST(Overlay, WhatIsWithinIsAndWhatIsFarIsAsFar) {
  SplitMix64 random(7);
  const auto unit = [&] { return random.unit(); };
  int within = 0, far = 0;
  for (int round = 0; round < 60; ++round) {
    const double rough = 0.3 * unit() * unit();
    const Sheet sheet = lattice(6, [&](const Vec3d&) { return rough * unit(); });
    const LinkedSurface linked = sheet.linked();
    const std::size_t most_pieces = round % 4 < 2 ? 48 : 3;  // 3: most pieces are left uncut
    Overlay overlay(linked, most_pieces, round % 2 == 0 ? Overlay::Cuts::kAll : Overlay::Cuts::kNeeded);
    for (int i = 0; i < 10; ++i) {
      const Vec3d at(unit(), unit(), 0.1 * unit());
      TriangleCorners t;
      for (Vec3d& p : t) p = at + 0.4 * Vec3d(unit(), unit(), 0.2 * unit());
      const double known = 0.2 * unit();
      const double truth = sampled(sheet, t);
      if (overlay.is_within(t, nearest(sheet, t[0]), known)) {
        EXPECT_LE(truth, known * (1.0 + 1e-9));
        ++within;
      } else {
        for (const Overlay::Far& f : overlay.far()) {
          if (f.distance == 0.0) continue;
          EXPECT_NEAR(f.distance, sheet.distance_to(f.at), 1e-6);
        }
        EXPECT_LE(truth, bound_of(overlay, known) * (1.0 + 1e-9));
        ++far;
      }
    }
  }
  EXPECT_GT(within, 50);
  EXPECT_GT(far, 50);
}

TEST(Overlay, NothingIsCutWhereItIsNearEnough) {
  const Sheet sheet = lattice(8, [](const Vec3d&) { return 0.0; });
  const LinkedSurface linked = sheet.linked();
  const TriangleCorners above{Vec3d(0.1, 0.1, 0.01), Vec3d(0.9, 0.2, 0.01), Vec3d(0.4, 0.8, 0.01)};
  Overlay overlay(linked, 96, Overlay::Cuts::kNeeded);
  EXPECT_TRUE(overlay.is_within(above, nearest(sheet, above[0]), 5.0));
  EXPECT_TRUE(overlay.below().empty());
  EXPECT_TRUE(overlay.is_within(above, nearest(sheet, above[0]), 0.0101));
  EXPECT_FALSE(overlay.is_within(above, nearest(sheet, above[0]), 0.0099));
}

/// The planes that part the triangles around a vertex leave room between them: what lies there is beyond each triangle,
/// as the planes say, and is near to all of them.
TEST(Overlay, WhatLiesOverAVertexIsMeasured) {
  SplitMix64 random(11);
  const auto unit = [&] { return random.unit(); };
  int are_within = 0;
  std::size_t left = 0;
  for (int round = 0; round < 200; ++round) {
    Sheet sheet;
    sheet.positions = {Vec3d(0.0)};
    const std::uint32_t sides = 4 + static_cast<std::uint32_t>(round) % 4;
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double angle = 6.283185307179586 * (i + 0.5 * unit()) / sides, radius = 0.5 + unit();
      sheet.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.8 * (unit() - 0.5));
      sheet.triangles.push_back({0, i + 1, (i + 1) % sides + 1});
    }
    sheet.link();
    const LinkedSurface linked = sheet.linked();
    const double height = 0.4 * (unit() - 0.5);
    TriangleCorners t;
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = 6.283185307179586 * (static_cast<double>(k) + 0.5 * unit()) / 3.0;
      t[k] = {0.1 * std::cos(angle), 0.1 * std::sin(angle), height};
    }
    const double truth = sampled(sheet, t);
    for (const Overlay::Cuts cuts : {Overlay::Cuts::kAll, Overlay::Cuts::kNeeded}) {
      Overlay overlay(linked, 48, cuts);
      EXPECT_FALSE(overlay.is_within(t, nearest(sheet, t[0]), 0.9 * truth)) << round;
      are_within += overlay.is_within(t, nearest(sheet, t[0]), 1.1 * truth) ? 1 : 0;
      EXPECT_LT(bound_of(overlay, 1.1 * truth), 1.5 * truth) << round;
      left += overlay.rest().size();
    }
  }
  EXPECT_GT(left, 0U);
  EXPECT_GT(are_within, 380);  // of 400; of the rest no single triangle is near to a piece that goes round
}

TEST(Overlay, BordersNeedlesAndCrowdedEdgesEndNothing) {
  Sheet sheet;
  sheet.positions = {Vec3d(0.0),           Vec3d(1.0, 0.0, 0.0), Vec3d(0.5, 1.0, 0.0), Vec3d(0.5, -1.0, 0.0),
                     Vec3d(0.5, 0.0, 1.0), Vec3d(0.5, 0.0, 0.0)};
  sheet.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 5, 1}, {2, 2, 2}};  // three at one edge, a needle, a point
  sheet.link();
  const LinkedSurface linked = sheet.linked();
  for (const Overlay::Cuts cuts : {Overlay::Cuts::kAll, Overlay::Cuts::kNeeded}) {
    Overlay overlay(linked, 48, cuts);
    for (std::uint32_t start = 0; start < sheet.triangles.size(); ++start) {
      const TriangleCorners t{Vec3d(-0.2, -0.5, 0.1), Vec3d(1.2, -0.4, 0.1), Vec3d(0.5, 0.9, 0.0)};
      const double truth = sampled(sheet, t);
      for (const double share : {0.1, 0.9, 1.1, 10.0}) {
        const bool is_within = overlay.is_within(t, start, share * truth);
        EXPECT_FALSE(is_within && share < 1.0) << start;
        EXPECT_LE(truth, bound_of(overlay, share * truth) * (1.0 + 1e-9)) << start;
      }
    }
  }
}

}  // namespace
}  // namespace meshlode::builder
