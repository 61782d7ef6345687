// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/write/instance_scale.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <meshlode/format.h>

#include "support/random.h"

namespace meshlode::builder {
namespace {

Mat4d with_linear_part(const Mat3d& linear) {
  Mat4d out(1.0);
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) out[c][r] = linear[c][r];
  }
  return out;
}

Mat3d rotation(test::Random& random) {
  double w = random.signed_unit();
  double x = random.signed_unit();
  double y = random.signed_unit();
  double z = random.signed_unit();
  const double n = std::sqrt(w * w + x * x + y * y + z * z);
  w /= n, x /= n, y /= n, z /= n;
  return {1 - 2 * (y * y + z * z), 2 * (x * y + w * z),     2 * (x * z - w * y),
          2 * (x * y - w * z),     1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
          2 * (x * z + w * y),     2 * (y * z - w * x),     1 - 2 * (x * x + y * y)};
}

Mat3d diagonal(double x, double y, double z) {
  return {x, 0, 0, 0, y, 0, 0, 0, z};
}

TEST(InstanceScale, AxisAlignedScalingsAreExact) {
  EXPECT_EQ(measure_instance(Mat4d(1.0)).largest, 1.0);
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(0.1, -3.0, 2.0))).largest, 3.0);
  const Mat3d turned{0, 0.3, 0, 0, 0, 7.1, -0.2, 0, 0};
  EXPECT_EQ(measure_instance(with_linear_part(turned)).largest, 7.1);
}

// A = U·D·V with rotations U and V has the singular values of D.
TEST(InstanceScale, BoundsTheKnownSingularValueTightly) {
  test::Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double size = std::ldexp(1.0, static_cast<int>(random.below(600)) - 300);
    const double a = size;
    const double b = size * std::abs(random.signed_unit());
    const double c = i % 5 == 0 ? b : size * random.signed_unit();
    if (b * c == 0.0 || std::abs(b * c) < size * size * 1e-9) continue;
    const Mat3d linear = rotation(random) * diagonal(a, b, c) * rotation(random);
    const InstanceScale scale = measure_instance(with_linear_part(linear));
    ASSERT_GE(scale.largest, a * (1.0 - 1e-15)) << "seed 1, case " << i;
    ASSERT_LE(scale.largest, a * (1.0 + 1e-11)) << "seed 1, case " << i;
    ASSERT_EQ(scale.flags, c < 0.0 ? format::kInstanceMirrored : 0U) << "seed 1, case " << i;
  }
}

TEST(InstanceScale, NoVectorIsStretchedFurther) {
  test::Random random(2);
  for (int i = 0; i < 2000; ++i) {
    Mat3d linear;
    for (int c = 0; c < 3; ++c) {
      for (int r = 0; r < 3; ++r) linear[c][r] = random.signed_unit();
    }
    const double largest = measure_instance(with_linear_part(linear)).largest;
    for (int k = 0; k < 100; ++k) {
      const Vec3d v(random.signed_unit(), random.signed_unit(), random.signed_unit());
      ASSERT_LE(glm::length(linear * v), largest * glm::length(v)) << "seed 2, case " << i;
    }
  }
}

TEST(InstanceScale, FlatAndBrokenTransformsAreSingular) {
  test::Random random(3);
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(0, 0, 0))).flags, format::kInstanceSingular);
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(1, 1, 0))).flags, format::kInstanceSingular);
  for (int i = 0; i < 1000; ++i) {
    const Mat3d flat = rotation(random) * diagonal(1, random.signed_unit(), 0) * rotation(random);
    EXPECT_EQ(measure_instance(with_linear_part(flat)).flags, format::kInstanceSingular) << "seed 3, case " << i;
  }
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Mat4d m(1.0);
    m[3][1] = bad;
    EXPECT_EQ(measure_instance(m).flags, format::kInstanceSingular);
    EXPECT_EQ(measure_instance(m).largest, 0.0);
  }
  Mat4d huge = with_linear_part(diagonal(1, 1, 1));
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) huge[c][r] = (c == r ? 1.7e308 : 1.6e308);
  }
  EXPECT_TRUE(std::isfinite(measure_instance(huge).largest));
}

TEST(InstanceScale, ThinIsNotFlat) {
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(1, 1, 1e-9))).flags, 0U);
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(1e-200, 1e-200, 1e-200))).flags, 0U);
  EXPECT_EQ(measure_instance(with_linear_part(diagonal(1e200, -1e200, 1e200))).flags, format::kInstanceMirrored);
}

}  // namespace
}  // namespace meshlode::builder
