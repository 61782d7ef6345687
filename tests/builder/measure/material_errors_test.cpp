// SPDX-License-Identifier: GPL-3.0-or-later
// How far materials move, in DAGs where it is known.
#include "builder/measure/material_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "builder/measure/measure_levels.h"
#include "hand_made.h"

namespace meshlode::builder {
namespace {

using test::cut_of;
using test::HandMade;
using test::sampled_distance;
using test::Soup;
using test::source_of;

constexpr std::uint32_t kWall = 0, kPane = 1;

/// A part of the plane z = 0, of unit height but for `height`.
struct Patch {
  double from, to;
  std::uint32_t material;
  double height = 1.0;
};
/// Clusters of patches, triangles sorted by material as in a DAG. The DAG: a root, and levels from coarse to fine.
HandMade make(const std::vector<std::vector<Patch>>& levels) {
  HandMade made;
  made.mesh.diagonal = 1000.0;
  auto level = static_cast<std::uint32_t>(levels.size() - 1);
  for (std::size_t i = 0; i < levels.size(); ++i, --level) {
    made.add_group(level, i == 0);
    Soup soup;
    for (const std::uint32_t material : {kWall, kPane}) {
      for (const Patch& patch : levels[i]) {
        if (patch.material != material) continue;
        const Vec3d a(patch.from, 0.0, 0.0), b(patch.to, 0.0, 0.0), c(patch.to, patch.height, 0.0),
            d(patch.from, patch.height, 0.0);
        soup.insert(soup.end(), {{a, b, c}, {a, c, d}});
        made.dag.triangle_material.insert(made.dag.triangle_material.end(), 2, material);
      }
    }
    made.add_cluster(level, level == 0 ? GroupId() : GroupId(i + 1), soup);
  }
  return made;
}
double error_of(const HandMade& made, std::size_t group) {
  const std::vector<double> errors = material_errors(made.mesh, made.dag);
  return errors.empty() ? 0.0 : errors[group];
}
/// All of it turned and made larger. Coordinates are rounded to the grid, whose step grows as well.
HandMade turned(HandMade made, std::int32_t log2) {
  for (Vec3i& p : made.dag.vertex_position) p = {3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.x};
  made.mesh.grid.log2 += log2;
  made.mesh.diagonal = std::ldexp(made.mesh.diagonal, log2 + 3);
  return made;
}

TEST(MaterialErrors, AWallThatPanesReplaceIsOffByTheDistanceToWhatIsLeft) {
  // 40 high, so that the area does not limit: of the wall from 4 to 6 the end is 5 from the one from 0 to 1.
  const HandMade made =
      make({{{0, 1, kWall, 40}, {1, 6, kPane, 40}}, {{0, 1, kWall, 40}, {1, 4, kPane, 40}, {4, 6, kWall, 40}}});
  EXPECT_NEAR(error_of(made, 1), 5.0, 1e-6);
}

TEST(MaterialErrors, WhatIsNowhereLeftIsOffByItsSize) {
  const auto of = [](const std::vector<Patch>& before) { return error_of(make({{{0, 9, kWall}}, before}), 1); };
  EXPECT_NEAR(of({{0, 1.75, kWall}, {1.75, 2, kPane, 0.25}, {2, 9, kWall}}), 0.25, 1e-6);
  // Two pieces count together, but for no more than the group's extent.
  EXPECT_NEAR(of({{0, 1, kPane, 0.5}, {1, 8, kWall}, {8, 9, kPane, 0.5}}), 1.0, 1e-6);
  const std::vector<Patch> hundred(100, Patch{0, 1, kPane});
  std::vector<Patch> before = hundred;
  before.push_back({1, 2, kWall});
  EXPECT_NEAR(of(before), std::sqrt(5.0), 1e-6);
}

TEST(MaterialErrors, ABorderThatMovesCounts) {
  const HandMade made = make({{{0, 2.5, kWall}, {2.5, 4, kPane}}, {{0, 2, kWall}, {2, 4, kPane}}});
  EXPECT_NEAR(error_of(made, 1), 0.5, 1e-6);
  for (const std::int32_t log2 : {-40, 0, 40}) {
    EXPECT_NEAR(error_of(turned(made, log2), 1), std::ldexp(0.5 * std::sqrt(50.0), log2), std::ldexp(1e-5, log2));
  }
}

TEST(MaterialErrors, WhatStaysIsNotOff) {
  const std::vector<Patch> patches{{0, 2, kWall}, {2, 4, kPane}, {4, 4, kWall}, {1, 3, kPane}};  // one without area
  const HandMade made = make({patches, patches});
  for (const std::int32_t log2 : {-40, 0, 40}) EXPECT_EQ(error_of(turned(made, log2), 1), 0.0);
}

TEST(MaterialErrors, SquaresOfLevelsAddUp) {
  const HandMade made = make(
      {{{0, 2.75, kWall}, {2.75, 4, kPane}}, {{0, 2.375, kWall}, {2.375, 4, kPane}}, {{0, 2, kWall}, {2, 4, kPane}}});
  EXPECT_NEAR(error_of(made, 2), 0.375, 1e-6);
  EXPECT_NEAR(error_of(made, 1), std::hypot(0.375, 0.375), 1e-6);
}

TEST(MaterialErrors, ThereAreNoneOfOneMaterial) {
  const HandMade made = make({{{0, 3, kWall}}, {{0, 4, kWall}}});
  EXPECT_TRUE(material_errors(made.mesh, made.dag).empty());
}

/// What a group is off by is no less, and cuts that it takes part in are held to it: the group on the left is replaced
/// at 0.25, the one on the right, whose material moves, not before 1.
TEST(MaterialErrors, MixedCutsAreHeldToThem) {
  const auto strip = [](double from, double to, double height) {
    const Vec3d a(from, 0.0, height), b(to, 0.0, height), c(to, 1.0, height), d(from, 1.0, height);
    return Soup{{a, b, c}, {a, c, d}};
  };
  const auto error_of_left = [&](double right) {
    HandMade made;
    made.add_group(1, true);
    made.add_cluster(1, GroupId(1U), strip(0, 0.25, 0.25));
    made.add_cluster(1, GroupId(2U), strip(0.25, 3, 0.25));
    made.add_group(0, false);
    made.add_cluster(0, GroupId(), strip(0, 2, 0));
    made.add_group(0, false);
    made.add_cluster(0, GroupId(), strip(2, 3, 0));
    Result<CanonicalForm> form = canonical_form(made.mesh, made.dag);
    EXPECT_TRUE(form);
    const std::vector<double> least{0.0, 0.0, right};
    measure_levels(made.mesh, SourceTree(made.mesh.exact_positions, made.mesh.exact_triangles), *form, 1.0, made.dag,
                   kMostRounds, least);
    EXPECT_EQ(made.dag.groups[2].error, std::max(right, 0.25));
    // What the left group's error allows, with the right one's members.
    const Soup cut = cut_of(made.mesh, made.dag, made.dag.groups[1].error);
    EXPECT_LE(sampled_distance(source_of(made.mesh), cut, 64), made.dag.groups[1].error + 1e-6);
    return made.dag.groups[1].error;
  };
  EXPECT_NEAR(error_of_left(0.0), 0.25, 1e-6);
  EXPECT_GT(error_of_left(1.0), 0.8);
}

}  // namespace
}  // namespace meshlode::builder
