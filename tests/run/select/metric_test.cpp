// SPDX-License-Identifier: GPL-3.0-or-later
// The rule itself: what passes, and that passing is monotone in the floats as they are (I4 => I5).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

#include "run/read/nesting.h"
#include "run/select/random_dag.h"
#include "run/select/select.h"

namespace meshlode::run {
namespace {

using test::RandomSource;
using test::TransformKind;

format::InstanceRecord identity_instance() {
  RandomSource random(1);
  return test::make_random_instance(random, TransformKind::kIdentity, 0.0);
}

bool passes(const MetricView& view, const StoredBound& b) {
  return metric_passes(view, b.center[0], b.center[1], b.center[2], b.radius, b.error);
}

TEST(Metric, FollowsTheRuleOnAnExampleDoneByHand) {
  Camera camera;  // k = 1000 pixels: height 2000, tan(fovy/2) = 1
  camera.eye = {0.0, 0.0, 10.0};
  camera.fovy = 2.0 * std::atan(1.0);
  camera.height = 2000;
  const MetricView view = make_metric_view(camera, 2.0, identity_instance(), format::MeshRecord{}, 4.0);
  // d = 10, r = 2: 8 units away, an error of x covers 1000·x/8 pixels; 2 pixels are allowed: x <= 0.016.
  EXPECT_TRUE(passes(view, {{0, 0, 0}, 2.0F, 0.01599F}));
  EXPECT_FALSE(passes(view, {{0, 0, 0}, 2.0F, 0.01601F}));
  EXPECT_TRUE(passes(view, {{0, 0, -2}, 0.0F, 0.0239F}));  // d = 12
  EXPECT_FALSE(passes(view, {{0, 0, -2}, 0.0F, 0.0241F}));
}

// docs/reference/selection.md: E <= near or (E + R)^2 <= d^2. All of these are small whole numbers, so that nothing is
// rounded.
TEST(Metric, PassesWhereBothSidesAreEqual) {
  MetricView view{};
  view.row0.x = view.row1.y = view.row2.z = 1.0F;
  view.scale = view.error_scale = 1.0F;
  view.near_distance = 0.5F;
  EXPECT_TRUE(passes(view, {{3, 4, 0}, 3.0F, 2.0F}));
  EXPECT_FALSE(passes(view, {{3, 4, 0}, 3.0F, 2.0F + 0x1p-20F}));
  EXPECT_FALSE(passes(view, {{3, 4, 0}, 3.0F + 0x1p-20F, 2.0F}));
  EXPECT_TRUE(passes(view, {{3, 4, 0}, 9.0F, 0.5F})) << "inside of the sphere, by the near distance";
  EXPECT_FALSE(passes(view, {{3, 4, 0}, 9.0F, 0.5F + 0x1p-20F}));
}

// The example done by hand, with the world and the mesh as small and as large as floats hold the bounds.
TEST(Metric, FollowsTheRuleAtEverySizeOfMeshAndInstance) {
  for (int mesh_log2 = -110; mesh_log2 <= 110; mesh_log2 += 11) {
    for (int scale_log2 = -300; scale_log2 <= 300; scale_log2 += 20) {
      const double unit = std::ldexp(1.0, mesh_log2), sigma = std::ldexp(1.0, scale_log2);
      format::InstanceRecord instance = identity_instance();
      for (double& x : instance.transform) x *= sigma;
      instance.scale = sigma;
      Camera camera;
      camera.eye = {0.0, 0.0, 10.0 * unit * sigma};
      camera.near_distance = 1e-6 * unit * sigma;
      camera.fovy = 2.0 * std::atan(1.0);
      camera.height = 2000;
      const MetricView view = make_metric_view(camera, 2.0, instance, format::MeshRecord{}, 4.0 * unit);
      const auto f = static_cast<float>(unit);
      EXPECT_TRUE(passes(view, {{0, 0, 0}, 2.0F * f, 0.01599F * f})) << mesh_log2 << " " << scale_log2;
      EXPECT_FALSE(passes(view, {{0, 0, 0}, 2.0F * f, 0.01601F * f})) << mesh_log2 << " " << scale_log2;
    }
  }
}

// From pixels to distances: the quotient times 1 + 2^-20, rounded up, as far as normal floats go. An orthographic
// camera's lengths are those of the world.
TEST(Metric, TheFactorOfErrorsIsTightAsFarAsNormalFloatsGo) {
  Camera camera;
  camera.is_orthographic = true;
  camera.ortho_height = 1.0;
  camera.height = 1000;
  for (int log2 = -125; log2 <= 125; ++log2) {
    for (const double part : {0.51, 0.73, 0.98}) {
      const double exact = std::ldexp(part, log2);
      const double pixel_error = camera.height / exact;
      if (exact < 0x1p-126) continue;
      const MetricView view = make_metric_view(camera, pixel_error, identity_instance(), format::MeshRecord{}, 1.0);
      EXPECT_GE(double{view.error_scale}, exact * (1.0 + 0x1p-20) * (1.0 - 1e-14)) << log2;
      EXPECT_LE(double{view.error_scale}, exact * (1.0 + 0x1p-20) * (1.0 + 0x1p-23)) << log2 << ": an ulp";
    }
  }
}

// docs/reference/selection.md: the scale is sigma * (1 + 2^-20), rounded up.
TEST(Metric, TheScaleIsRoundedUp) {
  RandomSource random(6);
  for (int i = 0; i < 1000; ++i) {
    const double sigma = random.between(1.0, 2.0);
    format::InstanceRecord instance = identity_instance();
    for (double& x : instance.transform) x *= sigma;
    instance.scale = sigma;
    Camera camera;
    camera.eye = {0.0, 0.0, 3.0};
    const MetricView view = make_metric_view(camera, 1.0, instance, format::MeshRecord{}, 1.0);
    const double unit = std::ldexp(1.0, std::ilogb(double{view.row0.x} / sigma * 1.5));
    EXPECT_GE(double{view.scale}, sigma * (1.0 + 0x1p-20) * unit * (1.0 - 1e-15)) << i;
    EXPECT_LE(double{view.scale}, sigma * (1.0 + 0x1p-20) * unit * (1.0 + 0x1p-23)) << i;
  }
}

// docs/reference/selection.md derives how much of each margin rounding may use, in units of 2^-24.
TEST(Metric, TheMarginsAreWhatTheProofNeeds) {
  constexpr double kUnit = 0x1p-24;
  EXPECT_GE(kNestingRadiusMargin, 5.1 * kUnit);
  EXPECT_GE(kNestingCenterMargin, 5.2 * kUnit);
  EXPECT_GE(kNestingErrorMargin, 10.3 * kUnit);
  EXPECT_GT(kNestingErrorGrowth, kNestingErrorMargin);
}

TEST(Metric, UsesTheNearDistanceInsideASphere) {
  Camera camera;
  camera.eye = {0.1, 0.2, 0.3};
  camera.near_distance = 0.5;
  camera.fovy = 2.0 * std::atan(1.0);
  camera.height = 2000;
  const MetricView view = make_metric_view(camera, 1.0, identity_instance(), format::MeshRecord{}, 2.0);
  EXPECT_TRUE(passes(view, {{0, 0, 0}, 2.0F, 0.000499F}));  // 1000·x/0.5 <= 1
  EXPECT_FALSE(passes(view, {{0, 0, 0}, 2.0F, 0.000501F}));
}

TEST(Metric, IgnoresDistanceWhenOrthographic) {
  Camera camera;
  camera.is_orthographic = true;
  camera.ortho_height = 10.0;
  camera.height = 1000;  // 100 pixels a unit
  for (const double z : {0.0, 1.0, 1e9}) {
    camera.eye = {0.0, 0.0, z};
    const MetricView view = make_metric_view(camera, 1.0, identity_instance(), format::MeshRecord{}, 2.0);
    EXPECT_TRUE(passes(view, {{0, 0, 0}, 2.0F, 0.00999F}));
    EXPECT_FALSE(passes(view, {{0, 0, 0}, 2.0F, 0.01001F}));
  }
}

TEST(Metric, NeverPassesATerminalGroup) {
  Camera camera;
  for (const bool ortho : {false, true}) {
    camera.is_orthographic = ortho;
    for (const double t : {0.0, 1e-30, 1.0, 1e30, HUGE_VAL, std::nan("")}) {
      const MetricView view = make_metric_view(camera, t, identity_instance(), format::MeshRecord{}, 2.0);
      EXPECT_FALSE(passes(view, {{0, 0, 0}, 0.0F, format::kInfiniteError}));
      EXPECT_FALSE(passes(view, {{0, 0, 0}, 0.0F, HUGE_VALF}));
      EXPECT_FALSE(passes(view, {{0, 0, 0}, 0.0F, std::nanf("")}));
    }
  }
}

TEST(Metric, PassesEverythingFiniteAtAnInfinitePixelErrorAndOnlyZeroAtZero) {
  Camera camera;
  camera.eye = {0.0, 0.0, 100.0};
  for (const bool ortho : {false, true}) {
    camera.is_orthographic = ortho;
    const MetricView all = make_metric_view(camera, HUGE_VAL, identity_instance(), format::MeshRecord{}, 2.0);
    EXPECT_TRUE(passes(all, {{0, 0, 0}, 2.0F, 1e6F}));
    for (const double t : {0.0, -1.0, std::nan("")}) {
      const MetricView none = make_metric_view(camera, t, identity_instance(), format::MeshRecord{}, 2.0);
      EXPECT_TRUE(passes(none, {{0, 0, 0}, 2.0F, 0.0F}));
      EXPECT_FALSE(passes(none, {{0, 0, 0}, 0.0F, 0x1p-126F}));
      EXPECT_FALSE(passes(none, {{0, 0, 0}, 0.0F, 1.0F}));
    }
  }
}

TEST(Metric, DoesNotChangeWhenTheWorldIsScaledByAPowerOfTwo) {
  RandomSource random(3);
  for (int i = 0; i < 2000; ++i) {
    format::InstanceRecord a = test::make_random_instance(random, TransformKind::kSheared, 10.0);
    format::InstanceRecord b = a;
    const double s = std::ldexp(1.0, static_cast<int>(random.below(121)) - 60);
    for (double& x : b.transform) x *= s;
    b.scale *= s;
    Camera ca, cb;
    ca.eye = random.in_cube(20.0);
    cb.eye = ca.eye * s;
    cb.near_distance = ca.near_distance * s;
    const format::MeshRecord mesh{};
    const MetricView va = make_metric_view(ca, 1.0, a, mesh, 3.0), vb = make_metric_view(cb, 1.0, b, mesh, 3.0);
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the same bits are promised.
    EXPECT_EQ(std::memcmp(&va, &vb, sizeof(va)), 0) << i;
  }
}

struct Nested {
  StoredBound finer, coarser;
};

float above(double x) {
  const float f = static_cast<float>(x);
  return double{f} < x ? std::nextafter(f, HUGE_VALF) : f;
}

// Two bounds that nest as tightly as the margins allow: times `margin`, to see that the margins are needed.
Nested make_tight_pair(RandomSource& random, double size, double offset, double margin) {
  const Vec3d base = random.direction() * offset;
  const auto stored = [](const Vec3d& c) {
    return StoredBound{{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)}, 0.0F, 0.0F};
  };
  const auto vec = [](const StoredBound& b) { return Vec3d(b.center[0], b.center[1], b.center[2]); };
  Nested n{stored(base + random.in_cube(size)), stored(base + random.in_cube(size))};
  if (random.chance(0.2)) n.coarser = n.finer;
  n.finer.radius = random.chance(0.2) ? 0.0F : static_cast<float>(size * random.log_between(1e-4, 1.0));
  n.finer.error = random.chance(0.1) ? 0.0F : static_cast<float>(size * random.log_between(1e-6, 1.0));
  const double needed = glm::length(vec(n.finer) - vec(n.coarser)) +
                        n.finer.radius * (1.0 + margin * kNestingRadiusMargin) +
                        margin * kNestingCenterMargin * (glm::length(vec(n.finer)) + glm::length(vec(n.coarser)));
  n.coarser.radius = above(needed / (1.0 - margin * kNestingRadiusMargin) * (1.0 + margin * 1e-14));
  n.coarser.error = above(n.finer.error * (1.0 + margin * kNestingErrorMargin));
  return n;
}

// Cameras at which the coarser bound is within a few ulp of passing, on the line through both centres where the
// distance to the finer one is smallest: the worst case for monotonicity.
std::uint64_t count_violations(std::uint64_t seed, std::uint32_t triples, double margin, std::uint64_t* decided) {
  RandomSource random(seed);
  constexpr std::array kKinds{TransformKind::kIdentity, TransformKind::kRigid, TransformKind::kMirrored,
                              TransformKind::kNonUniform, TransformKind::kSheared};
  std::uint64_t violations = 0;
  *decided = 0;
  for (std::uint32_t i = 0; i < triples; ++i) {
    const double size = std::array{1e-6, 1e-3, 1.0, 1e9}[random.below(4)];
    const double offset = random.chance(0.3) ? size * 1e6 : size * random.log_between(1e-2, 1e3);
    const Nested n = make_tight_pair(random, size, offset, margin);
    if (margin >= 1.0) {
      EXPECT_TRUE(is_nested(n.coarser, n.finer));
    }
    const TransformKind kind = kKinds[random.below(5)];  // drawn in order: that of arguments is the compiler's
    const double away = random.chance(0.3) ? size * 1e6 : size;
    const format::InstanceRecord instance = test::make_random_instance(random, kind, away);
    const double* m = instance.transform;
    const auto to_world = [&](const StoredBound& b) {
      Vec3d w;
      for (int r = 0; r < 3; ++r) {
        w[r] = m[4 * r] * b.center[0] + m[4 * r + 1] * b.center[1] + m[4 * r + 2] * b.center[2] + m[4 * r + 3];
      }
      return w;
    };
    const Vec3d c = to_world(n.coarser), f = to_world(n.finer);
    const double apart = glm::length(f - c);
    Vec3d towards = apart > 0.0 && random.chance(0.7) ? (f - c) / apart : random.direction();
    const double world_radius = n.coarser.radius * instance.scale;
    const double distance = world_radius * (random.chance(0.5) ? 1.0 + random.log_between(1e-8, 1e-2)
                                                               : 1.0 + random.log_between(1e-2, 1e3));
    Camera camera;
    camera.eye = c + towards * distance;
    camera.near_distance = size * instance.scale * 1e-12;
    camera.fovy = random.between(0.1, 2.0);
    camera.is_orthographic = random.chance(0.1);
    camera.ortho_height = size;
    const double pixels = camera.height / (camera.is_orthographic ? size : 2.0 * std::tan(0.5 * camera.fovy));
    const double room = camera.is_orthographic ? 1.0 : glm::length(camera.eye - c) - world_radius;
    const double jitter = 1.0 + random.between(-1.0, 1.0) * (random.chance(0.5) ? 1e-6 : 1e-3);
    double t = n.coarser.error * instance.scale * pixels / std::max(room, 1e-9 * world_radius) * jitter;
    if (!(t > 0.0)) t = 1.0;
    const double reach = offset + 4.0 * size + n.coarser.radius;
    const MetricView view = make_metric_view(camera, t, instance, format::MeshRecord{}, reach);
    const bool coarser = passes(view, n.coarser), finer = passes(view, n.finer);
    *decided += coarser ? 1 : 0;
    violations += coarser && !finer ? 1 : 0;
  }
  return violations;
}

TEST(Metric, IsMonotoneInFloatsForTwoMillionPairsThatBarelyNest) {
  constexpr std::uint32_t kTriples = 2000000;
  std::uint64_t passing = 0;
  EXPECT_EQ(count_violations(11, kTriples, 1.0, &passing), 0U) << "seed 11";
  EXPECT_GT(passing, kTriples / 4);  // the cameras do lie on both sides of the border
  EXPECT_LT(passing, kTriples / 4 * 3);
}

TEST(Metric, IsNotMonotoneWithoutTheMargins) {
  std::uint64_t passing = 0;
  EXPECT_GT(count_violations(12, 300000, 0.0, &passing), 0U) << "seed 12";
}

// The other promise: what passes in floats passes in real numbers, for the part of the sphere inside the centre margin.
TEST(Metric, PassesOnlyWhatTheRealRulePasses) {
  RandomSource random(5);
  int passing = 0;
  for (int i = 0; i < 300000; ++i) {
    const double size = random.log_between(1e-6, 1e9);
    const Nested n = make_tight_pair(random, size, size * random.log_between(1e-2, 1e4), 1.0);
    const format::InstanceRecord instance = test::make_random_instance(random, TransformKind::kSheared, size);
    const double* m = instance.transform;
    Camera camera;
    const StoredBound& b = n.coarser;
    Vec3d world;
    for (int r = 0; r < 3; ++r) {
      world[r] = m[4 * r] * b.center[0] + m[4 * r + 1] * b.center[1] + m[4 * r + 2] * b.center[2] + m[4 * r + 3];
    }
    const double sigma = instance.scale;
    camera.eye = world + random.direction() * (b.radius * sigma * (1.0 + random.log_between(1e-6, 1e2)));
    camera.near_distance = size * sigma * 1e-6;
    const double k = camera.height / (2.0 * std::tan(0.5 * camera.fovy));
    const double norm = glm::length(Vec3d(b.center[0], b.center[1], b.center[2]));
    const double true_radius = (b.radius - 0x1p-21 * norm) * sigma;
    const double room = std::max(glm::length(world - camera.eye) - true_radius, camera.near_distance);
    const double t = b.error * sigma * k / room * (1.0 + random.between(-2e-6, 1e-5));
    const double reach = norm + b.radius;
    if (!(t > 0.0) || !passes(make_metric_view(camera, t, instance, format::MeshRecord{}, reach), b)) continue;
    ++passing;
    EXPECT_LE(b.error * sigma * k, t * room) << i;
  }
  EXPECT_GT(passing, 20000);
}

}  // namespace
}  // namespace meshlode::run
