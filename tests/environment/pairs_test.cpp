// SPDX-License-Identifier: GPL-3.0-or-later
// As rounding_test.cpp, without what fused multiply-add brings: with it GCC 12 makes other vectors.
#include <gtest/gtest.h>

namespace {

struct Pair {
  double a, b;
};

// What becomes of a call is not known to the caller, nor what it is called with to it.
[[gnu::noinline, gnu::noclone]] void round_to_floats(const Pair& in, Pair& out) {
  const double a = static_cast<float>(in.a), b = static_cast<float>(in.b);
  out = {a, b};
}

TEST(Environment, PairsOfDoublesAreRoundedToFloats) {
  volatile double a = 1.0 + 0x1p-40, b = 3.0 - 0x1p-40;
  const Pair in{a, b};
  Pair out{};
  round_to_floats(in, out);
  EXPECT_EQ(out.a, 1.0);
  EXPECT_EQ(out.b, 3.0);
}

}  // namespace
