// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/id_table.h"

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace meshlode {
namespace {

/// Numbers words by first use, hashed by `hash`.
template <class Hash>
class Numbering {
 public:
  Numbering(IdTable table, Hash hash) : table_(std::move(table)), hash_(hash) {}
  IdTable::Entry number(std::uint64_t word) {
    const auto entry = table_.find_or_insert(
        hash_(word), static_cast<std::uint32_t>(words_.size()), [&](std::uint32_t id) { return words_[id] == word; },
        [&](std::uint32_t id) { return hash_(words_[id]); });
    if (entry.is_new) words_.push_back(word);
    return entry;
  }
  [[nodiscard]] std::size_t size() const { return table_.size(); }

 private:
  IdTable table_;
  Hash hash_;
  std::vector<std::uint64_t> words_;
};

template <class Hash>
void expect_numbers_of_a_map(IdTable table, Hash hash) {
  Numbering numbering(std::move(table), hash);
  std::map<std::uint64_t, std::uint32_t> known;
  SplitMix64 random(11);
  for (int i = 0; i < 5000; ++i) {
    const std::uint64_t word = random.below(1500) << 40U;  // many come again
    const auto [expected, is_new] = known.try_emplace(word, static_cast<std::uint32_t>(known.size()));
    const IdTable::Entry entry = numbering.number(word);
    ASSERT_EQ(entry.id, expected->second) << word;
    ASSERT_EQ(entry.is_new, is_new) << word;
  }
  EXPECT_EQ(numbering.size(), known.size());
}

TEST(IdTable, NumbersAsAMapDoes) {
  const auto hash = [](std::uint64_t word) { return hash_word(0, word); };
  expect_numbers_of_a_map(IdTable(), hash);
  expect_numbers_of_a_map(IdTable(1), hash);
  expect_numbers_of_a_map(IdTable(1500), hash);
}

TEST(IdTable, ABadHashCostsTimeAlone) {
  expect_numbers_of_a_map(IdTable(), [](std::uint64_t) { return ~std::uint64_t{0}; });
  expect_numbers_of_a_map(IdTable(1500), [](std::uint64_t word) { return word; });  // equal in all low bits
}

TEST(IdTable, DoesNotGrowWithinTheRoomThatWasAskedFor) {
  for (const std::uint32_t room : {0U, 1U, 2U, 3U, 31U, 32U, 100U}) {
    IdTable table(room);
    for (std::uint32_t id = 0; id < room; ++id) {
      const auto no_growth = [&](std::uint32_t) -> std::uint64_t {
        ADD_FAILURE() << "grows at " << id << " of " << room;
        return 0;
      };
      (void)table.find_or_insert(
          id, id, [&](std::uint32_t other) { return other == id; }, no_growth);
    }
    EXPECT_EQ(table.size(), room);
  }
}

TEST(IdTable, LowBitsOfAHashDependOnAllWords) {
  std::set<std::uint64_t> low;
  for (std::uint64_t k = 0; k < 64; ++k) low.insert(hash_word(hash_word(0, k << 48U), 5) & 0xFFFU);
  EXPECT_GT(low.size(), 56U);  // 64 of 4096 places: one collision is expected
}

}  // namespace
}  // namespace meshlode
