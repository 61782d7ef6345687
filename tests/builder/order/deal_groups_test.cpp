// SPDX-License-Identifier: GPL-3.0-or-later
// Where pages end: filled in order, or where training views load least.
#include "builder/order/deal_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/random.h"

namespace meshlode::testing {
namespace {

using builder::deal_groups;
using builder::kPageFrameBytes;
using builder::ViewBits;

constexpr std::size_t kFirst = 900, kPage = 600;

struct SomeGroups {
  std::vector<std::size_t> bytes;
  std::vector<ViewBits> needs;
};

SomeGroups some_groups(SplitMix64& random, std::size_t count) {
  SomeGroups out;
  for (std::size_t g = 0; g < count; ++g) {
    out.bytes.push_back(random.below(8) == 0 ? kPage + 50 : 30 + random.below(270));
    ViewBits& bits = out.needs.emplace_back();
    bits.fill(0);
    for (std::uint64_t v = random.below(6); v > 0; --v) {
      const std::uint64_t view = 331 * random.below(6);
      bits[view / 64] |= std::uint64_t{1} << view % 64;
    }
  }
  return out;
}

/// What all views load of the pages behind the first, and a page for each request. None where a page is too large.
std::uint64_t cost_of(const SomeGroups& groups, std::span<const std::uint32_t> page_of) {
  std::uint64_t cost = 0;
  for (std::size_t begin = 0, end = 0; begin < page_of.size(); begin = end) {
    ViewBits any{};
    std::size_t bytes = kPageFrameBytes;
    for (end = begin; end < page_of.size() && page_of[end] == page_of[begin]; ++end) {
      bytes += groups.bytes[end];
      for (std::size_t w = 0; w < any.size(); ++w) any[w] |= groups.needs[end][w];
    }
    if (page_of[begin] == 0) continue;
    if (end - begin > 1 && bytes > kPage) return std::numeric_limits<std::uint64_t>::max();
    std::uint64_t views = 0;
    for (const std::uint64_t word : any) views += static_cast<std::uint64_t>(std::popcount(word));
    cost += (bytes + kPage) * views;
  }
  return cost;
}

TEST(DealGroups, WithoutViewsPagesAreFilledInOrder) {
  const std::vector<std::size_t> bytes{500, 300, 200, 300, 250, 700, 40, 500, 88};
  const std::vector<std::uint32_t> expected{0, 0, 1, 1, 2, 3, 4, 4, 5};
  EXPECT_EQ(deal_groups(bytes, kFirst, kPage), expected);
  EXPECT_TRUE(deal_groups({}, kFirst, kPage).empty());
}

TEST(DealGroups, WithViewsNoOtherPagesLoadLess) {
  SplitMix64 random(5);
  std::size_t better = 0;
  for (int round = 0; round < 200; ++round) {
    const SomeGroups groups = some_groups(random, 2 + random.below(11));
    const std::size_t count = groups.bytes.size();
    const std::vector<std::uint32_t> filled = deal_groups(groups.bytes, kFirst, kPage),
                                     page_of = deal_groups(groups.bytes, kFirst, kPage, groups.needs);
    const std::size_t first = static_cast<std::size_t>(std::count(filled.begin(), filled.end(), 0U));
    ASSERT_EQ(std::count(page_of.begin(), page_of.end(), 0U), first) << "the first page is filled";
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    for (std::uint32_t cuts = 0; cuts < 1U << (count - first); ++cuts) {
      std::vector<std::uint32_t> other(count, 0);
      for (std::size_t g = first; g < count; ++g) {
        const bool is_cut = g == first || (cuts >> (g - first) & 1U) != 0;
        other[g] = other[g - 1] + (is_cut ? 1 : 0);
      }
      least = std::min(least, cost_of(groups, other));
    }
    EXPECT_EQ(cost_of(groups, page_of), least) << round;
    better += least < cost_of(groups, filled) ? 1 : 0;
    for (std::size_t g = 1; g < count; ++g) ASSERT_LE(page_of[g] - page_of[g - 1], 1U);  // in order, none empty
  }
  EXPECT_GT(better, 50U) << "the views decide";
}

TEST(DealGroups, WhatNoViewNeedsFillsPages) {
  const std::vector<std::size_t> bytes{800, 140, 140, 140, 140, 140, 140, 140, 140};
  const std::vector<ViewBits> needs(bytes.size(), ViewBits{});
  EXPECT_EQ(deal_groups(bytes, kFirst, kPage, needs).back(), 2U);
}

}  // namespace
}  // namespace meshlode::testing
