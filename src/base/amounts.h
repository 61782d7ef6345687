// SPDX-License-Identifier: MIT
// Numbers as people write them: digits and a unit behind them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace meshlode {

struct AmountUnit {
  std::string_view suffix;
  std::uint64_t factor;  ///< at least 1
};

/// Digits, with one of the units behind them or none. Nothing for any other text, and beyond the largest. A suffix that
/// ends another one comes after it.
[[nodiscard]] std::optional<std::uint64_t> parse_amount(std::string_view text, std::span<const AmountUnit> units,
                                                        std::uint64_t largest);

/// Thousands and millions: "16M", "500K", "42". Nothing beyond 2^62.
[[nodiscard]] std::optional<std::uint64_t> parse_count(std::string_view text);

}  // namespace meshlode
