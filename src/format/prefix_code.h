// SPDX-License-Identifier: MIT
// Prefix codes of stored pages (docs/reference/format.md, Prefix codes): canonical, at most kMaxCodeBits long, one
// table a context. Small numbers are symbols themselves; larger ones are a symbol for their leading three bits and raw
// bits for the rest, because the low bits of a prediction's error are noise that no code shortens.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

namespace meshlode::format {

constexpr std::uint32_t kMaxCodeBits = 10;    ///< so that a decoding table is 2 KiB and all of a page's fit the cache
constexpr std::uint32_t kValueSymbols = 120;  ///< of numbers below 2^31

/// A number as symbol and raw bits: numbers below 4 are their own symbol; else, with k = bit_width - 1, the symbol is
/// 4 · (k - 1) + the two bits below the leading one, and k - 2 raw bits follow.
struct ValueToken {
  std::uint32_t symbol, raw_bits, raw;
};
[[nodiscard]] constexpr ValueToken token_of(std::uint32_t value) {
  if (value < 4) return {value, 0, 0};
  const auto k = static_cast<std::uint32_t>(std::bit_width(value)) - 1U;
  return {4U * (k - 1U) + (value >> (k - 2U) & 3U), k - 2U, value & ((1U << (k - 2U)) - 1U)};
}

/// Signed numbers are folded: 0 -1 1 -2 2 … become 0 1 2 3 4 …
[[nodiscard]] constexpr std::uint32_t fold(std::uint32_t value) {
  return value << 1U ^ (0U - (value >> 31U));
}
[[nodiscard]] constexpr std::uint32_t unfold(std::uint32_t value) {
  return value >> 1U ^ (0U - (value & 1U));
}

/// The code words that go with lengths: shorter ones first, then smaller symbols; written with their first bit lowest.
/// `codes` gets one word a symbol. False where the lengths are no prefix code: a complete one, or a single symbol of
/// length 1, or none at all.
[[nodiscard]] bool assign_codes(std::span<const std::uint8_t> lengths, std::span<std::uint16_t> codes);

}  // namespace meshlode::format
