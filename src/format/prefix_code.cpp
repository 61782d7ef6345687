// SPDX-License-Identifier: MIT
#include "format/prefix_code.h"

namespace meshlode::format {

namespace {

/// Ten bits in reverse, five at a time.
constexpr std::array<std::uint16_t, 32> make_reversed_halves() {
  std::array<std::uint16_t, 32> table{};
  for (std::uint32_t value = 0; value < 32; ++value) {
    for (std::uint32_t bit = 0; bit < 5; ++bit) {
      table[value] = static_cast<std::uint16_t>(table[value] | (value >> bit & 1U) << (4U - bit));
    }
  }
  return table;
}
constexpr auto kReversedHalves = make_reversed_halves();
static_assert(kMaxCodeBits == 10);

constexpr std::uint32_t reverse(std::uint32_t code, std::uint32_t length) {
  return (std::uint32_t{kReversedHalves[code & 31U]} << 5U | kReversedHalves[code >> 5U]) >> (kMaxCodeBits - length);
}

}  // namespace

bool assign_codes(std::span<const std::uint8_t> lengths, std::span<std::uint16_t> codes) {
  std::array<std::uint32_t, kMaxCodeBits + 1> count{};
  for (const std::uint8_t length : lengths) {
    if (length == 0) continue;
    if (length > kMaxCodeBits) return false;
    ++count[length];
  }
  std::uint32_t used = 0;
  std::uint32_t filled = 0;  // of 2^kMaxCodeBits
  std::array<std::uint32_t, kMaxCodeBits + 2> next{};
  for (std::uint32_t bits = 1; bits <= kMaxCodeBits; ++bits) {
    used += count[bits];
    filled += count[bits] << (kMaxCodeBits - bits);
    next[bits + 1] = (next[bits] + count[bits]) << 1U;
  }
  const bool is_complete = filled == 1U << kMaxCodeBits;
  if (!is_complete && used != 0 && !(used == 1 && count[1] == 1)) return false;
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    const std::uint32_t length = lengths[s];
    if (length == 0) continue;
    codes[s] = static_cast<std::uint16_t>(reverse(next[length]++, length));
  }
  return true;
}

}  // namespace meshlode::format
