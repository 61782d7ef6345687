// SPDX-License-Identifier: GPL-3.0-or-later
// How far materials move, in DAGs where it is known.
#include "builder/measure/material_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/box.h"
#include "base/disjoint_sets.h"
#include "builder/measure/measure_levels.h"
#include "built.h"
#include "hand_made.h"
#include "lab/samples/samples.h"
#include "support/sanitized.h"

namespace meshlode::builder {
namespace {

using test::Built;
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
std::vector<double> errors_of(HandMade made) {
  Result<CanonicalForm> form = canonical_form(made.mesh, made.dag);
  EXPECT_TRUE(form) << form.error().message();
  made.dag.triangles = form->triangles;
  return material_errors(made.mesh, *form, made.dag);
}
double error_of(const HandMade& made, std::size_t group) {
  const std::vector<double> errors = errors_of(made);
  return errors.empty() ? 0.0 : errors[group];
}
/// All of it turned and made larger. Coordinates are rounded to the grid, whose step grows as well.
HandMade turned(HandMade made, std::int32_t log2) {
  for (auto* positions : {&made.dag.vertex_position, &made.mesh.exact_on_grid}) {
    for (Vec3i& p : *positions) p = {3 * p.x - 4 * p.y, 4 * p.x + 3 * p.y, 5 * p.x};
  }
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

TEST(MaterialErrors, WhatIsNowhereLeftIsOffByTheSizeOfItsPiece) {
  const auto of = [](const std::vector<Patch>& before) { return error_of(make({{{0, 9, kWall}}, before}), 1); };
  EXPECT_NEAR(of({{0, 1.75, kWall}, {1.75, 2, kPane, 0.25}, {2, 9, kWall}}), 0.25, 1e-6);
  EXPECT_NEAR(of({{0, 1, kPane}, {1, 8, kWall}, {8.5, 9, kPane, 0.5}}), 1.0, 1e-6);      // the larger of two
  EXPECT_NEAR(of({{0, 1, kPane}, {1, 2, kPane}, {2, 9, kWall}}), std::sqrt(2.0), 1e-6);  // which are one here
  // Twenty in one place have a large area, but are no larger than the group.
  std::vector<Patch> before(20, Patch{0, 1, kPane});
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
  EXPECT_TRUE(errors_of(made).empty());
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

/// Of all of the source at once, with every triangle of a level's surface looked at: what material_errors() estimates.
class WholeSource {
 public:
  explicit WholeSource(const Built& built) : built_(built), pieces_(0) {
    std::map<std::array<std::int32_t, 4>, std::uint32_t> first;
    for_each_triangle([](const DagCluster& c) { return !c.own_group.is_valid(); },
                      [&](const std::array<Vec3i, 3>& corners, std::uint32_t material) {
                        source_.push_back({place(corners), material});
                        on_grid_.push_back(corners);
                      });
    pieces_ = DisjointSets(source_.size());
    for (std::uint32_t t = 0; t < source_.size(); ++t) {
      for (const Vec3i& p : on_grid_[t]) {
        const std::array<std::int32_t, 4> key{p.x, p.y, p.z, static_cast<std::int32_t>(source_[t].material)};
        (void)pieces_.join(first.try_emplace(key, t).first->second, t);
      }
    }
  }

  /// Once the groups below a level are replaced.
  double width_at(std::uint32_t level) {
    std::map<std::uint32_t, std::vector<TriangleDistance>> surface;
    const auto is_there = [&](const DagCluster& c) {
      const DagGroup& coarser = built_.dag.groups[c.coarser_group.value];
      return (!c.own_group.is_valid() || built_.dag.groups[c.own_group.value].level < level) &&
             (coarser.is_terminal || coarser.level >= level);
    };
    for_each_triangle(is_there, [&](const std::array<Vec3i, 3>& corners, std::uint32_t material) {
      surface[material].emplace_back(place(corners));
    });
    std::map<std::uint32_t, std::vector<std::pair<double, double>>> lost;  // of a piece: distances and areas
    for (std::uint32_t t = 0; t < source_.size(); ++t) {
      const auto& [a, b, c] = source_[t].corners;
      double most2 = 0.0;
      for (const Vec3d& x : {a, b, c, (a + b + c) / 3.0}) {
        double least2 = std::numeric_limits<double>::infinity();
        for (const TriangleDistance& one : surface[source_[t].material]) least2 = std::min(least2, one.squared_to(x));
        most2 = std::max(most2, least2);
      }
      lost[pieces_.find(t)].emplace_back(std::sqrt(most2), 0.5 * glm::length(glm::cross(b - a, c - a)));
    }
    double width = 0.0;
    for (auto& [piece, triangles] : lost) {
      std::sort(triangles.rbegin(), triangles.rend());
      double area = 0.0;
      for (const auto& [distance, more] : triangles) {
        area += more;
        width = std::max(width, std::min(distance, std::sqrt(area)));
      }
    }
    return width;
  }

  std::size_t triangles_at(std::uint32_t level) const {
    std::size_t count = 0;
    for (const DagCluster& c : built_.dag.clusters) count += c.level == level ? c.triangle_count : 0;
    return count;
  }

 private:
  struct Triangle {
    TriangleCorners corners;
    std::uint32_t material;
  };
  [[nodiscard]] TriangleCorners place(const std::array<Vec3i, 3>& corners) const {
    return {built_.mesh.grid.decode(corners[0]), built_.mesh.grid.decode(corners[1]),
            built_.mesh.grid.decode(corners[2])};
  }
  template <class IsThere, class Visit>
  void for_each_triangle(const IsThere& is_there, const Visit& visit) const {
    for (const DagCluster& c : built_.dag.clusters) {
      if (!is_there(c)) continue;
      for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t) {
        std::array<Vec3i, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
          corners[k] = built_.dag.vertex_position[c.first_vertex + built_.dag.triangles[t][k]];
        }
        visit(corners, built_.dag.triangle_material[t]);
      }
    }
  }

  const Built& built_;
  std::vector<Triangle> source_;
  std::vector<std::array<Vec3i, 3>> on_grid_;
  DisjointSets pieces_;
};

TEST(MaterialErrors, AreCloseToWhatAllOfTheSourceIsOffBy) {
  const auto wave = [](double x, double by) { return x - by * std::floor(x / by); };
  const scene::Primitive rock = lab::make_rock(meshlode::test::kIsSanitized ? 10 : 20),
                         plain = lab::make_terrain(48, 48);
  Box3d box;
  for (const Vec3d& p : plain.positions) box.add(p);
  const double side = box.size().x;
  const auto at = [&](const Vec3d& p, double by) {
    return Vec2d(wave(p.x / side, by) / by, wave(p.z / side, by) / by);
  };
  const std::vector<std::pair<const char*, scene::SourceMesh>> scenes{
      {"halves", test::in_two_materials(rock, [](std::size_t, const Vec3d& p) { return p.x > 0.1; })},
      {"stripes", test::in_two_materials(rock, [&](std::size_t, const Vec3d& p) { return wave(p.y, 0.3) < 0.15; })},
      {"panes", test::in_two_materials(plain,
                                       [&](std::size_t, const Vec3d& p) {
                                         const Vec2d in = at(p, 0.125);
                                         return in.x < 0.7 && in.y < 0.7;
                                       })},
      {"islands", test::in_two_materials(plain, [&](std::size_t, const Vec3d& p) {
         const Vec2d in = at(p, 0.25);
         return in.x < 0.3 && in.y < 0.3;
       })}};
  std::size_t compared = 0;
  for (const auto& [name, source] : scenes) {
    const Built built = test::build(source);
    LodDag dag = built.dag;
    const Result<CanonicalForm> form = canonical_form(built.mesh, dag);
    ASSERT_TRUE(form);
    dag.triangles = form->triangles;
    const std::vector<double> errors = material_errors(built.mesh, *form, dag);
    WholeSource whole(built);
    double estimate = 0.0;
    for (std::uint32_t level = 1; level < dag.level_count; ++level) {
      for (std::size_t g = 0; g < dag.groups.size(); ++g) {
        if (dag.groups[g].level < level && !dag.groups[g].is_terminal) estimate = std::max(estimate, errors[g]);
      }
      if (whole.triangles_at(level) > 1200) continue;  // the count would take seconds
      const double truth = whole.width_at(level);
      std::printf("%s, level %u, %zu triangles: %.2f times the truth\n", name, level, whole.triangles_at(level),
                  estimate / truth);
      EXPECT_GT(estimate, 0.8 * truth) << name << ", level " << level;
      EXPECT_LT(estimate, 1.75 * truth) << name << ", level " << level;
      ++compared;
    }
  }
  EXPECT_GE(compared, 12U);
}

}  // namespace
}  // namespace meshlode::builder
