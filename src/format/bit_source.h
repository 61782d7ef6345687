// SPDX-License-Identifier: MIT
// Prefix-coded streams read from one padded buffer. Reading never checks for the end: the buffer is padded by more than
// one cluster can take, and whoever reads a cluster looks at the end once behind it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "format/prefix_code.h"

namespace meshlode::format {

static_assert(std::endian::native == std::endian::little, "bits are loaded as they lie in memory");

/// By the next bits: symbols as length | symbol << 4, numbers as length | raw bits << 4 | leading bits << 9.
struct CodeTable {
  std::uint32_t mask = 0;  ///< which of the next bits: as many as the longest word has
  std::array<std::uint16_t, std::size_t{1} << kMaxCodeBits> entries;
};

/// \pre the buffer goes on for 8 bytes behind `at`
[[nodiscard]] inline std::uint64_t load_bits(const std::uint8_t* buffer, std::uint64_t at) {
  std::uint64_t word;
  std::memcpy(&word, buffer + at / 8, sizeof(word));
  return word >> at % 8;  // at least 57 bits: a code and its raw bits, or five times kQuickBits
}

/// Takes the code and raw bits at the front of `bits` and moves on.
[[nodiscard]] inline std::uint32_t next_value(std::uint64_t& bits, std::uint64_t& at, const CodeTable& table) {
  const std::uint32_t entry = table.entries[bits & table.mask];
  const std::uint32_t length = entry & 15U;
  const std::uint32_t raw_bits = entry >> 4U & 31U;
  const std::uint64_t raw = bits >> length;
  at += length + raw_bits;
  bits = raw >> raw_bits;
  return entry >> 9U << raw_bits | (static_cast<std::uint32_t>(raw) & ((1U << raw_bits) - 1U));
}
[[nodiscard]] inline std::uint32_t next_symbol(std::uint64_t& bits, std::uint64_t& at, const CodeTable& table) {
  const std::uint32_t entry = table.entries[bits & table.mask];
  at += entry & 15U;
  bits >>= entry & 15U;
  return entry >> 4U;
}

[[nodiscard]] inline std::uint32_t take_symbol(const std::uint8_t* buffer, std::uint64_t& at, const CodeTable& table) {
  std::uint64_t bits = load_bits(buffer, at);
  return next_symbol(bits, at, table);
}

/// What the symbols of a code mean.
enum class Meaning : std::uint8_t {
  kSymbol,  ///< themselves
  kNumber,  ///< those of token_of, with raw bits
  kFolded,  ///< the same, unfolded when it is read
};
[[nodiscard]] inline std::uint32_t next_meant(std::uint64_t& bits, std::uint64_t& at, const CodeTable& table,
                                              Meaning meaning) {
  if (meaning == Meaning::kSymbol) return next_symbol(bits, at, table);
  const std::uint32_t number = next_value(bits, at, table);
  return meaning == Meaning::kFolded ? unfold(number) : number;
}

/// What most numbers are read by: the next kQuickBits bits say a whole number, raw bits and all. An entry is its size
/// in bits | number << kQuickSizeBits, signed; 0 where it does not fit, and is read by the CodeTable. The size stands
/// lowest, and sums of a few sizes stay below the number: shifts and positions take entries as they are.
constexpr std::uint32_t kQuickBits = 11;
constexpr std::uint32_t kQuickSizeBits = 6;
using QuickTable = std::array<std::int16_t, std::size_t{1} << kQuickBits>;

/// False where the lengths are no prefix code.
[[nodiscard]] bool fill_code_table(std::span<const std::uint8_t> lengths, Meaning meaning, CodeTable& table);
/// False as above, and then neither table can be used.
[[nodiscard]] bool fill_code_tables(std::span<const std::uint8_t> lengths, Meaning meaning, CodeTable& table,
                                    QuickTable& quick);

}  // namespace meshlode::format
