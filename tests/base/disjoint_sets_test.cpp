// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/disjoint_sets.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace meshlode {
namespace {

TEST(DisjointSets, SayWhatALabelPerMemberSays) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    constexpr std::uint32_t kCount = 60;
    DisjointSets sets(kCount);
    std::vector<std::uint32_t> label(kCount);
    for (std::uint32_t i = 0; i < kCount; ++i) label[i] = i;
    for (int joins = 0; joins < 50; ++joins) {
      const auto a = static_cast<std::uint32_t>(random.below(kCount));
      const auto b = static_cast<std::uint32_t>(random.below(kCount));
      EXPECT_EQ(sets.join(a, b), label[a] != label[b]);
      const std::uint32_t from = label[a];
      for (std::uint32_t& l : label) l = l == from ? label[b] : l;
      for (std::uint32_t i = 0; i < kCount; ++i) {
        for (std::uint32_t j = 0; j < i; ++j) ASSERT_EQ(sets.find(i) == sets.find(j), label[i] == label[j]);
      }
    }
  }
}

TEST(DisjointSets, AChainInAnyDirectionIsOneSet) {
  constexpr std::uint32_t kCount = 1000000;
  DisjointSets up(kCount);
  DisjointSets down(kCount);
  for (std::uint32_t i = 1; i < kCount; ++i) {
    ASSERT_TRUE(up.join(i - 1, i));
    ASSERT_TRUE(down.join(kCount - i, kCount - 1 - i));
  }
  EXPECT_EQ(up.find(0), up.find(kCount - 1));
  EXPECT_EQ(down.find(0), down.find(kCount - 1));
}

TEST(DisjointSets, JoinedToAnotherASetTakesItsName) {
  DisjointSets sets(6);
  EXPECT_TRUE(sets.join_to(4, 5));
  EXPECT_TRUE(sets.join_to(2, 4));
  EXPECT_TRUE(sets.join_to(2, 3));
  for (const std::uint32_t member : {2U, 3U, 4U, 5U}) EXPECT_EQ(sets.find(member), 2U);
  EXPECT_FALSE(sets.join_to(5, 3));
  EXPECT_TRUE(sets.join_to(1, 5));  // one member against four
  for (const std::uint32_t member : {1U, 2U, 3U, 4U, 5U}) EXPECT_EQ(sets.find(member), 1U);
  EXPECT_EQ(sets.find(0), 0U);
  EXPECT_TRUE(sets.join(0, 5));  // the larger keeps its name
  EXPECT_EQ(sets.find(0), 1U);
}

}  // namespace
}  // namespace meshlode
