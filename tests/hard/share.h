// SPDX-License-Identifier: GPL-3.0-or-later
// How much of a bound of docs/explanation/numerics.md was used: the largest share that a test saw.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>

namespace meshlode::test::hard {

/// The largest share, and where it was.
struct Worst {
  double share = 0.0;
  int at = -1;
  void take(double value, int where) {
    if (!(value <= share)) {
      share = value;
      at = where;
    }
  }
};

/// Fails where a share is above 1, and where all are so small that the test says nothing of the bound. Prints the
/// largest.
inline void expect_kept(const char* bound, const Worst& worst, double used_at_least) {
  std::printf("[ SHARE    ] %s: %.4f, in round %d\n", bound, worst.share, worst.at);
  EXPECT_LE(worst.share, 1.0) << bound;
  EXPECT_GE(worst.share, used_at_least) << bound << ": the test is not near the bound, and says nothing";
}

}  // namespace meshlode::test::hard
