// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/dense_ids.h"

#include <cstdint>
#include <set>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode {
namespace {

TEST(DenseIds, AreThePlacesAmongTheMembersInOrder) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    SplitMix64 random(seed);
    const std::uint32_t limit = 1 + random.scaled_below(400);
    DenseIds dense(limit);
    std::set<std::uint32_t> members;
    for (std::uint32_t i = 0; i < 150; ++i) {
      const std::uint32_t number = random.scaled_below(limit);
      members.insert(number);
      dense.add(number);
    }
    dense.finish();
    EXPECT_EQ(dense.count(), members.size());
    std::uint32_t place = 0;
    for (const std::uint32_t number : members) EXPECT_EQ(dense[number], place++) << number;
  }
}

TEST(DenseIds, TheEndsOfWords) {
  DenseIds dense(129);
  for (const std::uint32_t number : {0U, 63U, 64U, 127U, 128U}) dense.add(number);
  dense.finish();
  EXPECT_EQ(dense[0], 0U);
  EXPECT_EQ(dense[63], 1U);
  EXPECT_EQ(dense[64], 2U);
  EXPECT_EQ(dense[127], 3U);
  EXPECT_EQ(dense[128], 4U);
}

TEST(DenseIds, OfNothing) {
  DenseIds dense(0);
  dense.finish();
  EXPECT_EQ(dense.count(), 0U);
}

}  // namespace
}  // namespace meshlode
