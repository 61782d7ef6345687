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

}  // namespace meshlode
