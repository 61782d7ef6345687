// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps in the simplifier: against the closed form on a flat sheet, and on waves against the waves themselves.
#include "builder/simplify/gap_guard.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gtest/gtest.h>

#include "builder/prepare/prepare.h"
#include "lab/samples/samples.h"
#include "support/drawn_mesh.h"

namespace meshlode::builder {
namespace {

using test::as_input;
using test::DrawnMesh;

/// Two triangles in the plane z = 0 that face +z.
DrawnMesh square() {
  return DrawnMesh({{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}}, {{0, 1, 2}, {0, 2, 3}});
}

/// What is too much for the square of a vertex at the height, grid units.
double excess_at(double height, const GapPair& gaps, double reach = 64.0) {
  DrawnMesh drawn = square();
  SimplifyInput input = as_input(drawn.points, drawn.wedge_position, drawn.triangles);
  input.gap_reach = reach * input.grid.step();
  input.triangle_material.assign(2, with_gaps(7, gaps));
  const GapGuard guard(input, drawn.places);
  const Vec3d place = drawn.places.to_frame({50, 50, 0}) + Vec3d(0.0, 0.0, height / drawn.places.scale());
  return guard.excess(drawn.mesh, drawn.places, drawn.star(0, 2), place) * drawn.places.scale();
}

TEST(GapGuard, HalfOfTheGapMayBeUsedAndAStepOfTheGrid) {
  const GapPair above{3, 0}, below{0, 3};  // a gap of 16
  EXPECT_NEAR(excess_at(20.0, above), 11.0, 1e-9);
  EXPECT_EQ(excess_at(9.0, above), 0.0);
  EXPECT_EQ(excess_at(-1000.0, above), 0.0) << "away from the gap";
  EXPECT_NEAR(excess_at(-20.0, below), 11.0, 1e-9);
  EXPECT_EQ(excess_at(1000.0, below), 0.0);
  EXPECT_NEAR(excess_at(-20.0, {3, 4}), 15.0, 1e-9) << "a gap on each side";
  EXPECT_NEAR(excess_at(20.0, {3, 4}), 11.0, 1e-9);
}

TEST(GapGuard, WithoutGapsItIsOff) {
  DrawnMesh drawn = square();
  SimplifyInput input = as_input(drawn.points, drawn.wedge_position, drawn.triangles);
  input.gap_reach = 1.0;
  EXPECT_FALSE(GapGuard(input, drawn.places).is_on());
  input.triangle_material.assign(2, with_gaps(7, {1, 0}));
  EXPECT_TRUE(GapGuard(input, drawn.places).is_on());
  input.gap_reach = 0.0;
  EXPECT_FALSE(GapGuard(input, drawn.places).is_on());
}

TEST(GapGuard, APlaceInAGapIsMovedOutOfItAndNoFarther) {
  DrawnMesh drawn = square();
  SimplifyInput input = as_input(drawn.points, drawn.wedge_position, drawn.triangles);
  input.gap_reach = 64.0 * input.grid.step();
  input.triangle_material.assign(2, with_gaps(7, {3, 0}));
  const GapGuard guard(input, drawn.places);
  CollapseStar star = drawn.star(0, 2);
  star.target = drawn.places.to_frame({50, 50, 40});
  const Vec3d moved = guard.move_out(drawn.mesh, drawn.places, star);
  EXPECT_NEAR(glm::distance(moved, drawn.places.to_frame({50, 50, 9})), 0.0, 1e-12);
  star.target = drawn.places.to_frame({50, 50, -40});
  EXPECT_EQ(guard.move_out(drawn.mesh, drawn.places, star), star.target);
}

constexpr double kHeight = 0.1;
double wave(double x, double z) {
  return kHeight * std::sin(5.0 * x) * std::cos(4.0 * z);
}

/// How far a quarter of the triangles of waves rise above them and sink below, at most.
struct Moved {
  double up = 0.0, down = 0.0;
};

Moved simplified_waves(const GapPair& gaps, double reach) {
  scene::Primitive shape = lab::make_plane(24);
  for (Vec3d& p : shape.positions) p.y = wave(p.x, p.z);
  const PreparedMesh mesh = *prepare_mesh(lab::as_mesh(shape), {}, {});
  SimplifyInput input = as_input(mesh);
  input.gap_reach = reach;
  for (std::uint32_t& label : input.triangle_material) label = with_gaps(label, gaps);
  SimplifyOptions options;
  options.target_triangles = static_cast<std::uint32_t>(input.triangles.size() / 4);
  const SimplifyResult result = simplify_group(input, options);
  EXPECT_LE(result.triangles.size(), options.target_triangles);
  Moved moved;
  const auto at = [&](std::uint32_t wedge) {
    return mesh.origin + Vec3d(result.positions[result.wedge_position[wedge]]) * mesh.grid.step();
  };
  for (const WedgeTriangle& triangle : result.triangles) {
    const Vec3d a = at(triangle[0]), b = at(triangle[1]), c = at(triangle[2]);
    constexpr int kPoints = 6;
    for (int i = 0; i <= kPoints; ++i) {
      for (int k = 0; i + k <= kPoints; ++k) {
        const Vec3d p = a + ((b - a) * double(i) + (c - a) * double(k)) / double(kPoints);
        const double off = p.y - wave(std::clamp(p.x, -1.0, 1.0), std::clamp(p.z, -1.0, 1.0));
        moved.up = std::max(moved.up, off);
        moved.down = std::max(moved.down, -off);
      }
    }
  }
  return moved;
}

TEST(GapGuard, WavesAreSimplifiedFromTheSideThatIsFree) {
  constexpr double kGap = 0.001, kReach = kGap * 16.0;
  const Moved free = simplified_waves({}, kReach), held_down = simplified_waves({5, 0}, kReach),
              held_up = simplified_waves({0, 5}, kReach);
  EXPECT_GT(free.up, 8.0 * kGap);
  EXPECT_GT(free.down, 8.0 * kGap);
  // The source's own triangles are off the waves by this: a chord's height at the steepest bend.
  constexpr double kSource = kHeight * (5.0 * 5.0 + 4.0 * 4.0) / 8.0 / (12.0 * 12.0);
  EXPECT_LT(held_down.up, kGap + kSource);
  EXPECT_LT(held_up.down, kGap + kSource);
  // What it costs: the other side moves no more than twice as far.
  EXPECT_LT(held_down.down, 2.0 * (free.up + free.down));
  EXPECT_LT(held_up.up, 2.0 * (free.up + free.down));
}

}  // namespace
}  // namespace meshlode::builder
