// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/local_ids.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode {
namespace {

TEST(LocalIds, NumberByFirstUse) {
  LocalIds ids(2);
  EXPECT_EQ(ids.add(70), 0U);
  EXPECT_EQ(ids.add(0), 1U);
  EXPECT_EQ(ids.add(70), 0U);
  EXPECT_EQ(ids.add(4294967294U), 2U);
  EXPECT_EQ(ids.numbers(), (std::vector<std::uint32_t>{70, 0, 4294967294U}));
  ids.clear();
  EXPECT_EQ(ids.size(), 0U);
  EXPECT_EQ(ids.add(0), 0U);
}

TEST(LocalIds, SortingGivesThePlaceOfEach) {
  LocalIds ids;
  for (const std::uint32_t number : {9U, 2U, 5U, 2U}) ids.add(number);
  EXPECT_EQ(ids.sort(), (std::vector<std::uint32_t>{2, 0, 1}));
  EXPECT_EQ(ids.numbers(), (std::vector<std::uint32_t>{2, 5, 9}));
}

TEST(LocalIds, NothingSortsToNothing) {
  LocalIds ids(0);
  EXPECT_TRUE(ids.sort().empty());
  EXPECT_EQ(ids.add(3), 0U);
}

/// Against a map, past many growths: runs, multiples of powers of two, and anything.
TEST(LocalIds, AgreeWithAMap) {
  for (const std::uint32_t step : {1U, 64U, 65536U, 2654435769U}) {
    SplitMix64 random(step);
    LocalIds ids(1);
    std::map<std::uint32_t, std::uint32_t> known;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      const std::uint32_t number = step * random.scaled_below(6000) % 4294967295U;
      const auto [entry, is_new] = known.emplace(number, static_cast<std::uint32_t>(known.size()));
      ASSERT_EQ(ids.add(number), entry->second) << "step " << step;
    }
    const std::vector<std::uint32_t> before = ids.numbers();
    const std::vector<std::uint32_t> place = ids.sort();
    ASSERT_EQ(place.size(), known.size());
    EXPECT_TRUE(std::is_sorted(ids.numbers().begin(), ids.numbers().end()));
    for (std::uint32_t i = 0; i < before.size(); ++i) EXPECT_EQ(ids.numbers()[place[i]], before[i]);
  }
}

}  // namespace
}  // namespace meshlode
