// SPDX-License-Identifier: MIT
#include "coding/bit_source.h"

#include <algorithm>

namespace meshlode {

bool fill_code_table(std::span<const std::uint8_t> lengths, bool is_value, CodeTable& table) {
  std::array<std::uint16_t, 256> codes{};
  if (!assign_codes(lengths, codes)) return false;
  table.fill(0);
  const auto used = lengths.size() - static_cast<std::size_t>(std::count(lengths.begin(), lengths.end(), std::uint8_t{0}));
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    const std::uint32_t length = lengths[s];
    if (length == 0) continue;
    std::uint32_t entry = length;
    if (is_value && s >= 4) {
      entry |= static_cast<std::uint32_t>(s / 4 - 1) << 4U | static_cast<std::uint32_t>(4 + s % 4) << 9U;
    } else {
      entry |= static_cast<std::uint32_t>(s) << (is_value ? 9U : 4U);
    }
    for (std::size_t i = codes[s]; i < table.size(); i += used == 1 ? 1U : std::size_t{1} << length) {
      table[i] = static_cast<std::uint16_t>(entry);
    }
  }
  return true;
}

void fill_quick_table(std::span<const std::uint8_t> lengths, bool is_value, QuickTable& table) {
  std::array<std::uint16_t, 256> codes{};
  (void)assign_codes(lengths, codes);
  table.fill(0);
  const auto used = lengths.size() - static_cast<std::size_t>(std::count(lengths.begin(), lengths.end(), std::uint8_t{0}));
  for (std::size_t s = 0; s < lengths.size(); ++s) {
    const std::uint32_t length = lengths[s];
    const bool has_raw = is_value && s >= 8;
    const std::uint32_t raw_bits = has_raw ? static_cast<std::uint32_t>(s / 4 - 1) : 0U;
    const std::uint32_t lead = has_raw ? static_cast<std::uint32_t>(4 + s % 4) : static_cast<std::uint32_t>(s);
    if (length == 0 || length + raw_bits > kQuickBits || lead << raw_bits >= 1U << 12U) continue;
    for (std::uint32_t raw = 0; raw < 1U << raw_bits; ++raw) {
      const auto entry = static_cast<std::uint16_t>((length + raw_bits) | ((lead << raw_bits | raw) << 4U));
      // A lone symbol's word may be either bit.
      for (std::size_t i = codes[s] | raw << length; i < table.size();
           i += used == 1 && raw_bits == 0 ? 1U : std::size_t{1} << (length + raw_bits)) {
        table[i] = entry;
      }
    }
  }
}

}  // namespace meshlode
