// SPDX-License-Identifier: MIT
// Prefix-coded streams read from one padded buffer. Reading never checks for the end: the buffer is padded by more than one
// cluster can take, and whoever reads a cluster looks at the end once behind it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

#include "coding/prefix_code.h"

namespace meshlode {

static_assert(std::endian::native == std::endian::little, "bits are loaded as they lie in memory");

/// By the next kMaxCodeBits bits: symbols as length | symbol << 4, numbers as length | raw bits << 4 | leading bits << 9.
using CodeTable = std::array<std::uint16_t, std::size_t{1} << kMaxCodeBits>;

/// \pre the buffer goes on for 8 bytes behind `at`
[[nodiscard]] inline std::uint64_t load_bits(const std::uint8_t* buffer, std::uint64_t at) {
  std::uint64_t word;
  std::memcpy(&word, buffer + at / 8, sizeof(word));
  return word >> at % 8;  // at least 57 bits: a code and its raw bits, or five times kQuickBits
}

/// Takes the code and raw bits at the front of `bits` and moves on.
[[nodiscard]] inline std::uint32_t next_value(std::uint64_t& bits, std::uint64_t& at, const CodeTable& table) {
  const std::uint32_t entry = table[bits & (table.size() - 1)];
  const std::uint32_t length = entry & 15U;
  const std::uint32_t raw_bits = entry >> 4U & 31U;
  const std::uint64_t raw = bits >> length;
  at += length + raw_bits;
  bits = raw >> raw_bits;
  return entry >> 9U << raw_bits | (static_cast<std::uint32_t>(raw) & ((1U << raw_bits) - 1U));
}
[[nodiscard]] inline std::uint32_t next_symbol(std::uint64_t& bits, std::uint64_t& at, const CodeTable& table) {
  const std::uint32_t entry = table[bits & (table.size() - 1)];
  at += entry & 15U;
  bits >>= entry & 15U;
  return entry >> 4U;
}

[[nodiscard]] inline std::uint32_t take_symbol(const std::uint8_t* buffer, std::uint64_t& at, const CodeTable& table) {
  std::uint64_t bits = load_bits(buffer, at);
  return next_symbol(bits, at, table);
}

/// What most numbers are read by: the next kQuickBits bits say a whole number, raw bits too, as its bits | number << 4. 0
/// where the number is longer than that, and is read by the CodeTable.
constexpr std::uint32_t kQuickBits = 11;
using QuickTable = std::array<std::uint16_t, std::size_t{1} << kQuickBits>;

/// \pre fill_code_table was content with the same
void fill_quick_table(std::span<const std::uint8_t> lengths, bool is_value, QuickTable& table);

/// False where the lengths are no prefix code. `is_value`: symbols are those of token_of.
[[nodiscard]] bool fill_code_table(std::span<const std::uint8_t> lengths, bool is_value, CodeTable& table);

}  // namespace meshlode
