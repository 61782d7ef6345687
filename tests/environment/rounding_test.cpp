// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with the project's flags (MeshlodeCompiler.cmake), optimised: what the source rounds is rounded, once.
//   -ffp-contract=off      products are rounded before they are added, on processors with fused multiply-add too;
//   without it
//                          both compilers fuse some (GCC where GNU extensions are on, as they are here)
//   -fno-tree-slp-vectorize  GCC 12 leaves out the rounding of two doubles to floats and back that it makes one vector
//   of
#include <gtest/gtest.h>

#include <cmath>

namespace {

// Read where they are used: no compiler knows them.
volatile double unknown_double = 1.0 + 0x1p-52;
volatile float unknown_float = 1.0F + 0x1p-23F;
volatile double unknown_pair[2] = {1.0 + 0x1p-40, 3.0 - 0x1p-40};

TEST(Environment, ProductsAreRoundedBeforeTheyAreAdded) {
  if (!__builtin_cpu_supports("fma")) GTEST_SKIP() << "no fused multiply-add in this processor";
  const double d = unknown_double;  // d * d = 1 + 2^-51 + 2^-104
  EXPECT_EQ(d * d + (-1.0 - 0x1p-51), 0.0);
  EXPECT_EQ(std::fma(d, d, -1.0 - 0x1p-51), 0x1p-104);
  const float f = unknown_float;
  EXPECT_EQ(f * f + (-1.0F - 0x1p-22F), 0.0F);
  EXPECT_EQ(std::fma(f, f, -1.0F - 0x1p-22F), 0x1p-46F);
}

}  // namespace
