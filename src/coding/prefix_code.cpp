// SPDX-License-Identifier: MIT
#include "coding/prefix_code.h"

namespace meshlode {

bool assign_codes(std::span<const std::uint8_t> lengths, std::span<std::uint16_t> codes) {
  std::array<std::uint32_t, kMaxCodeBits + 1> count{};
  for (const std::uint8_t length : lengths) {
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
    std::uint32_t reversed = 0;
    const std::uint32_t code = next[length]++;
    for (std::uint32_t bit = 0; bit < length; ++bit) reversed |= (code >> bit & 1U) << (length - 1U - bit);
    codes[s] = static_cast<std::uint16_t>(reversed);
  }
  return true;
}

}  // namespace meshlode
