// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/match.h"

#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace meshlode::app {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
using Names = std::vector<std::string_view>;
using Indices = std::vector<std::size_t>;

TEST(Match, NamesComeBeforePlaces) {
  const Matches m = match_by_name({"a", "b", "c"}, {"c", "a", "d", "b"});
  EXPECT_EQ(m.pairs, (Pairs{{2, 0}, {0, 1}, {1, 3}}));
  EXPECT_EQ(m.removed, Indices{});
  EXPECT_EQ(m.added, Indices{2});
}

TEST(Match, TheNthOfANameIsTheNthOfIt) {
  const Matches m = match_by_name({"tree", "rock", "tree", "tree"}, {"tree", "tree"});
  EXPECT_EQ(m.pairs, (Pairs{{0, 0}, {2, 1}}));
  EXPECT_EQ(m.removed, (Indices{1, 3}));
  EXPECT_EQ(m.added, Indices{});
}

TEST(Match, WhatHasNoNameOrAnotherOneIsMatchedByItsPlace) {
  const Matches unnamed = match_by_name({"", ""}, {"", "", ""});
  EXPECT_EQ(unnamed.pairs, (Pairs{{0, 0}, {1, 1}}));
  EXPECT_EQ(unnamed.added, Indices{2});
  const Matches renamed = match_by_name({"a", "b"}, {"a", "B"});
  EXPECT_EQ(renamed.pairs, (Pairs{{0, 0}, {1, 1}}));
  // A place that its name has taken elsewhere is free for nobody.
  const Matches moved = match_by_name({"a", "b"}, {"c", "a"});
  EXPECT_EQ(moved.pairs, (Pairs{{0, 1}}));
  EXPECT_EQ(moved.removed, Indices{1});
  EXPECT_EQ(moved.added, Indices{0});
}

TEST(Match, EveryEntryIsInOnePairOrOneSided) {
  const std::vector<Names> lists = {{}, {"a"}, {"a", "a", "b"}, {"", "b", "a", ""}, {"c", "b", "", "a", "a", "b"}};
  for (const Names& before : lists) {
    for (const Names& after : lists) {
      const Matches m = match_by_name(before, after);
      std::vector<int> old_uses(before.size()), new_uses(after.size());
      for (const auto& [i, j] : m.pairs) {
        ++old_uses[i];
        ++new_uses[j];
      }
      for (const std::size_t i : m.removed) ++old_uses[i];
      for (const std::size_t j : m.added) ++new_uses[j];
      EXPECT_EQ(old_uses, std::vector<int>(before.size(), 1));
      EXPECT_EQ(new_uses, std::vector<int>(after.size(), 1));
    }
  }
}

}  // namespace
}  // namespace meshlode::app
