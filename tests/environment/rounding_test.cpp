// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled with the project's flags (MeshlodeCompiler.cmake), optimised, and for a processor that has fused
// multiply-add: products are rounded before they are added, and what is cut to a float has lost the rest.
// -ffp-contract=off is what keeps the first so; without it both compilers fuse some (GCC where GNU extensions are on,
// as they are here). -fno-tree-slp-vectorize is what keeps the second so: without it GCC 12 fails.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>

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

// Pairs side by side are what the vectorizer makes one vector of; nothing is known of them here.
struct Pair {
  double x, y;
};

[[gnu::noinline]] void round_fields(const Pair& from, Pair& to) {
  to.x = static_cast<float>(from.x);
  to.y = static_cast<float>(from.y);
}

[[gnu::noinline]] void round_many(const double* from, double* to, int pairs) {
  for (int i = 0; i < pairs; ++i) {
    to[2 * i] = static_cast<float>(from[2 * i]) * 2.0;
    to[2 * i + 1] = static_cast<float>(from[2 * i + 1]) * 4.0;
  }
}

TEST(Environment, WhatIsCutToAFloatHasLostTheRest) {
  const Pair thirds{unknown_double / 3.0, unknown_double / 5.0};
  Pair rounded{};
  round_fields(thirds, rounded);
  const volatile float x = static_cast<float>(thirds.x), y = static_cast<float>(thirds.y);
  ASSERT_NE(static_cast<double>(x), thirds.x);
  ASSERT_NE(static_cast<double>(y), thirds.y);
  EXPECT_EQ(rounded.x, static_cast<double>(x));
  EXPECT_EQ(rounded.y, static_cast<double>(y));
  std::array<double, 18> from{}, to{};
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = unknown_double / (3.0 + static_cast<double>(i));
  round_many(from.data(), to.data(), static_cast<int>(from.size() / 2));
  for (std::size_t i = 0; i < from.size(); ++i) {
    const volatile float cut = static_cast<float>(from[i]);
    EXPECT_EQ(to[i], static_cast<double>(cut) * (i % 2 == 0 ? 2.0 : 4.0)) << i;
  }
}

}  // namespace
