// SPDX-License-Identifier: GPL-3.0-or-later
// From a camera and an instance to the floats of the rule, and the margins of nesting: each number against its formula
// of docs/reference/selection.md, with eleven more bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "run/read/nesting.h"
#include "run/select/select.h"
#include "support/random.h"

namespace meshlode::run {
namespace {

using test::RandomSource;

constexpr double kTwice = 1.0 + 0x1p-20;  // the growth of the scale and of the factor of errors

struct Shot {
  Camera camera;
  format::InstanceRecord instance{};
  format::MeshRecord mesh{};
  double reach = 0.0;
  double pixel_error = 1.0;

  [[nodiscard]] MetricView view() const { return make_metric_view(camera, pixel_error, instance, mesh, reach); }
  [[nodiscard]] double entry(int row, int column) const { return instance.transform[4 * row + column]; }
  /// Of the mesh's origin relative to the eye, and what its terms add up to.
  [[nodiscard]] std::array<long double, 3> translation() const {
    std::array<long double, 3> out{};
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) out[row] += static_cast<long double>(entry(row, k)) * mesh.origin[k];
      out[row] += static_cast<long double>(entry(row, 3)) - camera.eye[row];
    }
    return out;
  }
  [[nodiscard]] long double distance() const {
    const auto t = translation();
    return std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]);
  }
};

Shot random_shot(RandomSource& random) {
  Shot shot;
  const double size = random.log_between(1e-9, 1e9);
  for (double& x : shot.instance.transform) x = random.signed_unit();
  for (int row = 0; row < 3; ++row) shot.instance.transform[4 * row + 3] *= size * random.log_between(1e-3, 1e6);
  shot.instance.scale = random.log_between(1e-3, 1e3);
  for (double& x : shot.mesh.origin) x = size * random.signed_unit();
  // Near the instance, so that the difference is far smaller than what is subtracted.
  for (int row = 0; row < 3; ++row) shot.camera.eye[row] = shot.entry(row, 3) + size * random.signed_unit();
  shot.camera.height = 1 + random.below(4000);
  shot.camera.width = 7;
  shot.camera.fovy = random.between(0.05, 2.5);
  shot.camera.near_distance = size * random.log_between(1e-9, 1e-3);
  shot.camera.ortho_height = size * random.log_between(1e-3, 1e3);
  shot.pixel_error = random.log_between(1e-2, 1e2);
  shot.reach = size * random.log_between(1e-3, 1e3);
  return shot;
}

/// The least float that is not below; `slack` of it is the rounding of doubles.
void expect_rounded_up(float found, long double exact, const char* what, int round) {
  constexpr long double kSlack = 0x1p-49L;
  EXPECT_GE(static_cast<long double>(found), exact * (1.0L - kSlack)) << what << ", round " << round;
  EXPECT_LE(static_cast<long double>(std::nextafter(found, 0.0F)), exact * (1.0L + kSlack))
      << what << ", round " << round;
}

TEST(MetricView, IsTheTransformRelativeToTheEyeInItsOwnUnit) {
  RandomSource random(151);
  for (int round = 0; round < 20000; ++round) {
    const Shot shot = random_shot(random);
    const MetricView view = shot.view();
    const auto translation = shot.translation();
    const long double sigma = shot.instance.scale;
    const long double largest = std::max(sigma * shot.reach, shot.distance());
    // The power of two that brings the largest length to [2^29, 2^30).
    const long double unit = std::ldexp(1.0L, 29 - std::ilogb(static_cast<double>(largest)));
    const long double scaled = largest * unit;
    ASSERT_GE(scaled, 0x1p29L * (1.0L - 1e-12L));
    ASSERT_LT(scaled, 0x1p30L * (1.0L + 1e-12L));
    const std::array<MetricVec4, 3> rows{view.row0, view.row1, view.row2};
    for (int row = 0; row < 3; ++row) {
      const std::array<float, 3> part{rows[row].x, rows[row].y, rows[row].z};
      for (int k = 0; k < 3; ++k) {
        ASSERT_EQ(part[k], static_cast<float>(shot.entry(row, k) * static_cast<double>(unit)))
            << "seed 151, round " << round;
      }
      const long double w = translation[row] * unit;
      long double terms = std::fabs(static_cast<long double>(shot.entry(row, 3)) - shot.camera.eye[row]);
      for (int k = 0; k < 3; ++k)
        terms += std::fabs(static_cast<long double>(shot.entry(row, k)) * shot.mesh.origin[k]);
      const long double rounding = unit * 0x1p-50L * terms + std::fabs(w) * 0x1p-24L;
      ASSERT_NEAR(static_cast<double>(rows[row].w), static_cast<double>(w), static_cast<double>(rounding))
          << "seed 151, round " << round;
    }
    expect_rounded_up(view.scale, sigma * unit * kTwice, "scale", round);
    const long double pixels =
        shot.camera.height / (2.0L * std::tan(static_cast<long double>(shot.camera.fovy) / 2.0L));
    const long double factor = sigma * pixels / shot.pixel_error * unit * kTwice;
    if (factor > 0x1p-126L && factor < 0x1p126L) expect_rounded_up(view.error_scale, factor, "factor", round);
    const auto near = static_cast<double>(shot.camera.near_distance * unit);
    ASSERT_EQ(view.near_distance, static_cast<float>(std::clamp(near, 0x1p-40, 0x1p61))) << "seed 151, round " << round;
    ASSERT_EQ(view.reserved, 0.0F);
    if (::testing::Test::HasFailure()) FAIL() << "seed 151, round " << round;
  }
}

TEST(MetricView, OfAnOrthographicCameraIsAFactorAlone) {
  RandomSource random(152);
  for (int round = 0; round < 5000; ++round) {
    Shot shot = random_shot(random);
    shot.camera.is_orthographic = true;
    const MetricView view = shot.view();
    const long double pixels = shot.camera.height / static_cast<long double>(shot.camera.ortho_height);
    expect_rounded_up(view.error_scale, shot.instance.scale * pixels / shot.pixel_error * kTwice, "factor", round);
    ASSERT_EQ(view.near_distance, 1.0F);
    ASSERT_EQ(view.scale, 0.0F);
    for (const MetricVec4& row : {view.row0, view.row1, view.row2}) {
      for (const float part : {row.x, row.y, row.z, row.w}) ASSERT_EQ(part, 0.0F);
    }
  }
}

// What leaves the range of normal floats is held at its ends: a factor of 0 would let everything pass.
TEST(MetricView, NumbersBeyondFloatsAreHeldAtTheirLimits) {
  RandomSource random(153);
  const double nan = std::nan(""), infinity = HUGE_VAL;
  for (int round = 0; round < 200; ++round) {
    Shot shot = random_shot(random);
    const auto with = [&](auto change) {
      Shot changed = shot;
      change(changed);
      return changed.view();
    };
    for (const bool is_orthographic : {false, true}) {
      shot.camera.is_orthographic = is_orthographic;
      EXPECT_EQ(with([](Shot& s) { s.pixel_error = 1e300; }).error_scale, 0x1p-126F);
      EXPECT_EQ(with([&](Shot& s) { s.pixel_error = infinity; }).error_scale, 0x1p-126F);
      EXPECT_EQ(with([](Shot& s) { s.pixel_error = 1e-100; }).error_scale, 0x1p126F);
      for (const double none : {0.0, -1.0, nan}) {
        const MetricView view = with([&](Shot& s) { s.pixel_error = none; });
        EXPECT_EQ(view.error_scale, 0x1p126F);
        EXPECT_EQ(view.near_distance, 0x1p-40F);
        EXPECT_EQ(view.scale, 0.0F);
      }
    }
    shot.camera.is_orthographic = false;
    for (const double none : {nan, infinity}) {
      EXPECT_EQ(with([&](Shot& s) { s.instance.scale = none; }).scale, 0x1p126F);
      EXPECT_EQ(with([&](Shot& s) { s.camera.near_distance = none; }).near_distance, 0x1p61F);
    }
    EXPECT_EQ(with([](Shot& s) { s.camera.near_distance = 1e40; }).near_distance, 0x1p61F);
    EXPECT_EQ(with([](Shot& s) { s.camera.near_distance = -1.0; }).near_distance, 0x1p-40F);
    EXPECT_EQ(with([](Shot& s) { s.camera.near_distance = 0.0; }).near_distance, 0x1p-40F);
    EXPECT_EQ(with([](Shot& s) { s.instance.scale = 0.0; }).scale, 0.0F);
  }
}

// Where the mesh is tiny against its scale, rows stay below 2^100; where there is no length, or none that is finite,
// the unit is 1.
TEST(MetricView, TheUnitLeavesTheRowsFarFromOverflow) {
  for (int log2 = -1000; log2 <= 1000; log2 += 7) {
    for (const int sigma_log2 : {-300, 0, 100, 400}) {
      Shot shot;
      for (int k = 0; k < 3; ++k) shot.instance.transform[5 * k] = std::ldexp(0.75, sigma_log2);
      shot.instance.scale = std::ldexp(0.75, sigma_log2);
      shot.camera.eye = Vec3d(0.0);
      shot.reach = std::ldexp(1.0, log2 - sigma_log2);
      const double length = shot.instance.scale * shot.reach;  // in [2^(log2 - 1), 2^log2)
      if (!(length > 1e-300) || !(length < 1e300) || !(shot.reach < 1e300)) continue;
      const int unit = std::clamp(std::min(30 - log2, 100 - sigma_log2), -1000, 1000);
      const double row = std::ldexp(0.75, sigma_log2 + unit);
      const MetricView view = shot.view();
      EXPECT_EQ(view.row0.x, static_cast<float>(row)) << log2 << ", " << sigma_log2;
      EXPECT_EQ(view.row1.y, static_cast<float>(row)) << log2 << ", " << sigma_log2;
      EXPECT_LE(view.row2.z, 0x1p100F) << log2 << ", " << sigma_log2;
    }
  }
  // A scale of 0 limits nothing.
  Shot flat;
  flat.instance.transform[0] = 0.75;
  flat.camera.eye = Vec3d(0x1p-90, 0.0, 0.0);
  EXPECT_EQ(flat.view().row0.x, static_cast<float>(0.75 * 0x1p119));
  for (const double none : {0.0, HUGE_VAL, std::nan("")}) {
    Shot shot;
    shot.instance.transform[0] = 0.75;
    shot.instance.scale = 0.75;
    shot.camera.eye = Vec3d(0.0);
    shot.reach = none;
    EXPECT_EQ(shot.view().row0.x, 0.75F) << none;
  }
}

TEST(MeshReach, IsAsFarAsTheRootsSphereReaches) {
  RandomSource random(154);
  for (int round = 0; round < 1000; ++round) {
    std::vector<format::NodeRecord> nodes(3);
    format::MeshRecord mesh{};
    mesh.first_node = 1 + random.below(2);
    mesh.node_count = 1;
    long double length2 = 0.0L;
    format::NodeRecord& root = nodes[mesh.first_node];
    for (float& c : root.center) {
      c = static_cast<float>(random.signed_unit() * 1e3);
      length2 += static_cast<long double>(c) * c;
    }
    root.radius = static_cast<float>(random.log_between(1e-3, 1e3));
    SelectTables tables;
    tables.nodes = nodes;
    const auto expected = static_cast<double>(std::sqrt(length2) + root.radius);
    EXPECT_NEAR(mesh_reach(tables, mesh), expected, 1e-15 * expected);
    mesh.node_count = 0;
    EXPECT_EQ(mesh_reach(tables, mesh), 0.0);
  }
}

constexpr long double kUnit = 0x1p-24L;

TEST(Nesting, TheSlackIsWhatTheProofLeavesOfTheRadius) {
  RandomSource random(155);
  for (int round = 0; round < 20000; ++round) {
    const double size = random.log_between(1e-20, 1e20);
    StoredBound outer{}, inner{};
    for (int k = 0; k < 3; ++k) {
      outer.center[k] = static_cast<float>(size * random.signed_unit());
      inner.center[k] =
          static_cast<float>(outer.center[k] + size * random.log_between(1e-6, 1.0) * random.signed_unit());
    }
    inner.radius = static_cast<float>(size * random.log_between(1e-6, 10.0));
    outer.radius = static_cast<float>(size * random.log_between(1e-6, 10.0));
    const auto length = [](long double x, long double y, long double z) { return std::sqrt(x * x + y * y + z * z); };
    const auto& o = outer.center;
    const auto& i = inner.center;
    const long double needed = length(static_cast<long double>(o[0]) - i[0], static_cast<long double>(o[1]) - i[1],
                                      static_cast<long double>(o[2]) - i[2]) +
                               inner.radius * (1.0L + 6.0L * kUnit) +
                               6.0L * kUnit * (length(o[0], o[1], o[2]) + length(i[0], i[1], i[2]));
    const long double slack = outer.radius * (1.0L - 6.0L * kUnit) - needed;
    ASSERT_NEAR(nesting_slack(outer, inner), static_cast<double>(slack),
                static_cast<double>(1e-15L * (needed + outer.radius)))
        << "seed 155, round " << round;
    outer.radius = static_cast<float>(needed * (1.0L + 8.0L * kUnit));
    EXPECT_TRUE(is_sphere_nested(outer, inner)) << "seed 155, round " << round;
    outer.radius = static_cast<float>(needed * (1.0L + 4.0L * kUnit));
    EXPECT_FALSE(is_sphere_nested(outer, inner)) << "seed 155, round " << round;
  }
  EXPECT_TRUE(is_sphere_nested({}, {})) << "points at the origin need no margin";
  StoredBound none{};
  none.radius = std::nanf("");
  EXPECT_FALSE(is_sphere_nested(none, {}));
  EXPECT_FALSE(is_sphere_nested({}, none));
}

TEST(Nesting, ErrorsNestFromTwelveUnitsOn) {
  RandomSource random(156);
  for (int round = 0; round < 5000; ++round) {
    const auto inner = static_cast<float>(random.log_between(1e-30, 1e30));
    // The least float above the margin, and the one below it.
    auto least = static_cast<float>(static_cast<double>(inner) * (1.0 + 12.0 * 0x1p-24));
    if (static_cast<double>(least) < static_cast<double>(inner) * (1.0 + 12.0 * 0x1p-24))
      least = std::nextafter(least, HUGE_VALF);
    EXPECT_TRUE(is_error_nested(least, inner)) << "seed 156, round " << round;
    EXPECT_FALSE(is_error_nested(std::nextafter(least, 0.0F), inner)) << "seed 156, round " << round;
    StoredBound coarser{{0, 0, 0}, 2.0F, least}, finer{{0, 0, 0}, 1.0F, inner};
    EXPECT_TRUE(is_nested(coarser, finer));
    finer.radius = 2.0F;
    EXPECT_FALSE(is_nested(coarser, finer)) << "both have to";
    finer.radius = 1.0F;
    coarser.error = inner;
    EXPECT_FALSE(is_nested(coarser, finer)) << "both have to";
    const float grown = coarser_error(inner);
    const double exact = static_cast<double>(inner) * (1.0 + 0x1p-18);
    EXPECT_GE(static_cast<double>(grown), exact);
    EXPECT_LT(static_cast<double>(std::nextafter(grown, 0.0F)), exact) << "the least float that is not below";
  }
  EXPECT_TRUE(is_error_nested(0.0F, 0.0F));
  EXPECT_FALSE(is_error_nested(0.0F, 0x1p-100F));
  EXPECT_TRUE(is_error_nested(0x1p-100F, 0.0F));
  EXPECT_TRUE(is_error_nested(format::kInfiniteError, format::kInfiniteError));
  EXPECT_TRUE(is_error_nested(format::kInfiniteError, 1.0F));
  const float nan = std::nanf("");
  EXPECT_FALSE(is_error_nested(1.0F, nan));
  EXPECT_FALSE(is_error_nested(nan, 1.0F));
  EXPECT_FALSE(is_error_nested(1.0F, -1.0F));
  EXPECT_FALSE(is_error_nested(-1.0F, 0.0F));
  EXPECT_EQ(coarser_error(0.0F), 0.0F);
  EXPECT_EQ(coarser_error(format::kInfiniteError), format::kInfiniteError);
  const auto last = static_cast<float>(static_cast<double>(format::kInfiniteError) / (1.0 + 0x1.1p-18));
  EXPECT_LT(coarser_error(last), format::kInfiniteError);
}

}  // namespace
}  // namespace meshlode::run
