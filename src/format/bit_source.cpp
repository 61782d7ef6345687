// SPDX-License-Identifier: MIT
#include "format/bit_source.h"

#include <algorithm>

namespace meshlode::format {

namespace {

/// A symbol as the number that it begins.
struct Token {
  std::uint32_t lead, raw_bits;
};
Token token_of_symbol(std::uint32_t symbol, Meaning meaning) {
  if (meaning == Meaning::kSymbol || symbol < 4) return {symbol, 0};
  return {4 + symbol % 4, symbol / 4 - 1};
}

/// What the words of a code are; false as fill_code_table.
struct Words {
  std::array<std::uint16_t, 256> codes;
  std::uint32_t used = 0;
  std::uint32_t longest = 0;

  bool assign(std::span<const std::uint8_t> lengths) {
    for (const std::uint8_t length : lengths) {
      used += length != 0 ? 1U : 0U;
      longest = std::max(longest, std::uint32_t{length});
    }
    return longest <= kMaxCodeBits && assign_codes(lengths, codes);
  }
};

void fill_codes(std::span<const std::uint8_t> lengths, Meaning meaning, const Words& words, CodeTable& table) {
  table.mask = (1U << words.longest) - 1U;
  table.entries[0] = 0;
  for (std::uint32_t s = 0; s < lengths.size(); ++s) {
    const std::uint32_t length = lengths[s];
    if (length == 0) continue;
    const Token token = token_of_symbol(s, meaning);
    const std::uint32_t entry =
        meaning == Meaning::kSymbol ? length | s << 4U : length | token.raw_bits << 4U | token.lead << 9U;
    // A lone symbol's word may be either bit.
    for (std::size_t i = words.codes[s]; i <= table.mask; i += words.used == 1 ? 1U : std::size_t{1} << length) {
      table.entries[i] = static_cast<std::uint16_t>(entry);
    }
  }
}

}  // namespace

bool fill_code_table(std::span<const std::uint8_t> lengths, Meaning meaning, CodeTable& table) {
  Words words;
  if (!words.assign(lengths)) return false;
  fill_codes(lengths, meaning, words, table);
  return true;
}

bool fill_code_tables(std::span<const std::uint8_t> lengths, Meaning meaning, CodeTable& table, QuickTable& quick) {
  Words words;
  if (!words.assign(lengths)) return false;
  fill_codes(lengths, meaning, words, table);
  // The table grows from one entry: doubled, and then the words of the next size are put in, each once.
  std::array<std::uint8_t, 256> by_size;
  std::array<std::uint32_t, kQuickBits + 2> first{};
  const auto size_of = [&](std::uint32_t s) { return lengths[s] + token_of_symbol(s, meaning).raw_bits; };
  for (std::uint32_t s = 0; s < lengths.size(); ++s) {
    if (lengths[s] != 0 && size_of(s) <= kQuickBits) ++first[size_of(s) + 1];
  }
  for (std::size_t size = 1; size < first.size(); ++size) first[size] += first[size - 1];
  std::array<std::uint32_t, kQuickBits + 2> next = first;
  for (std::uint32_t s = 0; s < lengths.size(); ++s) {
    if (lengths[s] != 0 && size_of(s) <= kQuickBits) by_size[next[size_of(s)]++] = static_cast<std::uint8_t>(s);
  }
  quick[0] = 0;
  for (std::uint32_t size = 1; size <= kQuickBits; ++size) {
    std::copy_n(quick.begin(), std::size_t{1} << (size - 1), quick.begin() + (std::ptrdiff_t{1} << (size - 1)));
    for (std::uint32_t i = first[size]; i < first[size + 1]; ++i) {
      const std::uint32_t s = by_size[i];
      const Token token = token_of_symbol(s, meaning);
      for (std::uint32_t raw = 0; raw < 1U << token.raw_bits; ++raw) {
        const std::uint32_t number = token.lead << token.raw_bits | raw;
        const auto value = static_cast<std::int32_t>(meaning == Meaning::kFolded ? unfold(number) : number);
        const std::int32_t entry = value * (1 << kQuickSizeBits) + static_cast<std::int32_t>(size);
        if (entry != static_cast<std::int16_t>(entry)) break;  // nor do those that follow fit
        quick[words.codes[s] | raw << lengths[s]] = static_cast<std::int16_t>(entry);
        // A lone symbol's word may be either bit.
        if (words.used == 1) quick[(words.codes[s] ^ 1U) | raw << lengths[s]] = static_cast<std::int16_t>(entry);
      }
    }
  }
  return true;
}

}  // namespace meshlode::format
