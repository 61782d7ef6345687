// SPDX-License-Identifier: GPL-3.0-or-later
// The best prefix code of limited length for given counts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

/// Code lengths of at most kMaxCodeBits, 0 for symbols that do not occur; one symbol alone gets length 1.
/// \pre at most 2^kMaxCodeBits counts
[[nodiscard]] std::vector<std::uint8_t> choose_code_lengths(std::span<const std::uint64_t> counts);

}  // namespace meshlode::builder
