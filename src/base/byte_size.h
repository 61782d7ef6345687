// SPDX-License-Identifier: MIT
// Amounts of memory as people write them: "512MiB".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace meshlode {

/// Digits and a unit behind them: KiB, MiB, GiB (powers of 1024), KB, MB, GB or K, M, G (powers of 1000), B or nothing.
/// Nothing for any other text, and beyond 2^62.
[[nodiscard]] std::optional<std::uint64_t> parse_byte_size(std::string_view text);

/// The shortest of those texts where one is exact, else with one decimal, rounded up: "512MiB", "341.4MiB", "71B".
[[nodiscard]] std::string byte_size_text(std::uint64_t bytes);

}  // namespace meshlode
