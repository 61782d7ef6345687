// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with the project's flags (MeshlodeCompiler.cmake), optimised, and for a processor that has fused
// multiply-add: products are rounded before they are added. -ffp-contract=off is what keeps them so; without it both
// compilers fuse some (GCC where GNU extensions are on, as they are here).
#include <gtest/gtest.h>

#include <cmath>

namespace {

// Read where they are used: no compiler knows them.
volatile double unknown_double = 1.0 + 0x1p-52;
volatile float unknown_float = 1.0F + 0x1p-23F;

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
