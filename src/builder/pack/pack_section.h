// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and texts of a file as columns in prefix codes (docs/reference/format.md, Stored sections).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace meshlode::builder {

/// `record_bytes` is even, 0 for texts. Empty where the section would not shrink or would shrink beyond belief
/// (kMaxSectionRatio): it is then stored as it is.
[[nodiscard]] std::vector<std::uint8_t> pack_section(std::span<const std::uint8_t> bytes, std::uint32_t record_bytes);

/// Appends one column in the shortest of its modes.
void put_column(const std::vector<std::uint8_t>& column, std::vector<std::uint8_t>& out);

}  // namespace meshlode::builder
