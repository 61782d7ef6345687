// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/release.h"

#include <vector>

#include <gtest/gtest.h>

namespace meshlode {
namespace {

TEST(Release, NothingIsKept) {
  std::vector<int> numbers(1000, 7);
  std::vector<std::vector<double>> rows(3, std::vector<double>(50));
  release(numbers, rows[1]);
  EXPECT_EQ(numbers.capacity(), 0U);
  EXPECT_EQ(rows[1].capacity(), 0U);
  EXPECT_EQ(rows[2].size(), 50U);
  numbers.push_back(1);
  EXPECT_EQ(numbers.size(), 1U) << "it can be filled again";
}

}  // namespace
}  // namespace meshlode
