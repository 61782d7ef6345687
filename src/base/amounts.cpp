// SPDX-License-Identifier: MIT
#include "base/amounts.h"

#include <charconv>
#include <system_error>

namespace meshlode {

std::optional<std::uint64_t> parse_amount(std::string_view text, std::span<const AmountUnit> units,
                                          std::uint64_t largest) {
  std::uint64_t factor = 1;
  for (const AmountUnit& unit : units) {
    if (!text.ends_with(unit.suffix)) continue;
    text.remove_suffix(unit.suffix.size());
    factor = unit.factor;
    break;
  }
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number > largest / factor) return std::nullopt;
  return number * factor;
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  constexpr AmountUnit kUnits[] = {{"K", 1000}, {"M", 1000000}};
  return parse_amount(text, kUnits, std::uint64_t{1} << 62U);
}

}  // namespace meshlode
