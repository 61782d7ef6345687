// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "builder/pack/bit_sink.h"
#include "builder/pack/prefix_lengths.h"
#include "format/bit_source.h"
#include "format/prefix_code.h"
#include "support/random.h"

namespace meshlode::builder {
namespace {

double kraft(const std::vector<std::uint8_t>& lengths) {
  double sum = 0.0;
  for (const std::uint8_t l : lengths) sum += l == 0 ? 0.0 : std::ldexp(1.0, -l);
  return sum;
}

TEST(PrefixCode, FoldingIsUndoneForEveryBoundary) {
  for (const std::uint32_t value : {0U, 1U, 2U, 0xFFFFFFFFU, 0xFFFFFFFEU, 0x7FFFFFFFU, 0x80000000U}) {
    EXPECT_EQ(format::unfold(format::fold(value)), value);
  }
  EXPECT_EQ(format::fold(0U), 0U);
  EXPECT_EQ(format::fold(0xFFFFFFFFU), 1U);
  EXPECT_EQ(format::fold(1U), 2U);
}

TEST(PrefixCode, LengthsAreCompleteWithinTheLimitAndBeatAFixedWidth) {
  test::Random random(4);
  for (int round = 0; round < 50; ++round) {
    std::vector<std::uint64_t> counts(2 + random.below(214));
    std::uint64_t total = 0;
    for (std::size_t s = 0; s < counts.size(); ++s) {
      counts[s] = random.below(3) == 0 ? 0 : std::uint64_t{1} << random.below(30);
      total += counts[s];
    }
    counts[0] = counts[1] = 1;
    total += 2;
    const auto lengths = choose_code_lengths(counts);
    EXPECT_EQ(kraft(lengths), 1.0);
    std::uint64_t bits = 0;
    for (std::size_t s = 0; s < counts.size(); ++s) {
      EXPECT_LE(lengths[s], format::kMaxCodeBits);
      EXPECT_EQ(lengths[s] == 0, counts[s] == 0);
      bits += counts[s] * lengths[s];
    }
    EXPECT_LE(bits, total * 8);
  }
}

/// With powers of two and no limit in the way, a best code is as long as the entropy.
TEST(PrefixCode, LengthsReachTheEntropyOfDyadicCounts) {
  const std::vector<std::uint64_t> counts{128, 64, 32, 16, 8, 4, 2, 1, 1};
  EXPECT_EQ(choose_code_lengths(counts), (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 8}));
}

TEST(PrefixCode, NumbersOfEverySizeComeBack) {
  std::vector<std::uint32_t> values(300);
  std::iota(values.begin(), values.end(), 0U);
  for (std::uint32_t k = 2; k < 31; ++k) {
    for (const std::uint32_t offset : {0U, 1U}) {
      values.push_back((1U << k) - offset);
      values.push_back((1U << k) + (1U << (k - 1)) - offset);
    }
  }
  std::vector<std::uint64_t> counts(format::kValueSymbols);
  for (const std::uint32_t v : values) ++counts[format::token_of(v).symbol];
  const auto lengths = choose_code_lengths(counts);
  std::vector<std::uint16_t> codes(lengths.size());
  ASSERT_TRUE(format::assign_codes(lengths, codes));
  BitSink sink;
  for (const std::uint32_t v : values) {
    const format::ValueToken token = format::token_of(v);
    sink.put(codes[token.symbol], lengths[token.symbol]);
    sink.put(token.raw, token.raw_bits);
  }
  auto bytes = sink.finish();
  bytes.resize(bytes.size() + 16);
  format::CodeTable table;
  ASSERT_TRUE(format::fill_code_table(lengths, format::Meaning::kNumber, table));
  std::uint64_t at = 0;
  for (const std::uint32_t v : values) {
    std::uint64_t bits = format::load_bits(bytes.data(), at);
    ASSERT_EQ(format::next_value(bits, at, table), v);
  }
}

/// The quick table says what the other one says, or nothing.
TEST(PrefixCode, QuickTablesAgree) {
  test::Random random(11);
  for (int round = 0; round < 300; ++round) {
    const format::Meaning meaning = round % 3 == 0   ? format::Meaning::kSymbol
                                    : round % 3 == 1 ? format::Meaning::kNumber
                                                     : format::Meaning::kFolded;
    std::vector<std::uint64_t> counts(meaning == format::Meaning::kSymbol ? 216U : format::kValueSymbols);
    const std::uint64_t used = round < 6 ? 1 : 1 + random.below(counts.size());
    for (std::uint64_t k = 0; k < used; ++k) counts[random.below(counts.size())] += 1 + random.below(1000);
    const auto lengths = choose_code_lengths(counts);
    format::CodeTable slow;
    format::QuickTable quick;
    ASSERT_TRUE(format::fill_code_tables(lengths, meaning, slow, quick));
    std::size_t said = 0;
    for (std::uint64_t bits = 0; bits < quick.size(); ++bits) {
      if (quick[bits] == 0) continue;
      ++said;
      std::uint64_t rest = bits;
      std::uint64_t at = 0;
      const std::uint32_t value = format::next_meant(rest, at, slow, meaning);
      ASSERT_EQ(static_cast<std::uint32_t>(quick[bits] >> format::kQuickSizeBits), value)
          << "round " << round << ", bits " << bits;
      ASSERT_EQ(static_cast<std::uint32_t>(quick[bits]) & ((1U << format::kQuickSizeBits) - 1U), at);
    }
    if (meaning == format::Meaning::kSymbol) {
      EXPECT_EQ(said, quick.size()) << "symbols are never longer";
    }
  }
}

TEST(PrefixCode, LengthsThatAreNoCodeAreRefused) {
  format::CodeTable table;
  std::vector<std::uint8_t> lengths(format::kValueSymbols, 0);
  EXPECT_TRUE(format::fill_code_table(lengths, format::Meaning::kNumber, table)) << "nothing is coded";
  lengths[5] = 1;
  EXPECT_TRUE(format::fill_code_table(lengths, format::Meaning::kNumber, table)) << "one symbol";
  lengths[5] = 2;
  EXPECT_FALSE(format::fill_code_table(lengths, format::Meaning::kNumber, table)) << "half of the codes mean nothing";
  lengths[5] = lengths[6] = lengths[7] = 1;
  EXPECT_FALSE(format::fill_code_table(lengths, format::Meaning::kNumber, table)) << "more codes than there are";
  lengths[5] = format::kMaxCodeBits + 1;
  EXPECT_FALSE(format::fill_code_table(lengths, format::Meaning::kNumber, table)) << "too long";
}

}  // namespace
}  // namespace meshlode::builder
