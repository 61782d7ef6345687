// SPDX-License-Identifier: GPL-3.0-or-later
// Checksums of an asset written anew after a test has changed it, so that the checks behind them are reached.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

namespace meshlode::test {

/// Recomputes what can be recomputed and skips what lies outside the file: page, blob, section and header checksums.
/// The content hash stays as it is. Safe on any bytes.
void reseal(std::vector<std::uint8_t>& asset);

/// Where a section's bytes begin. \pre the asset has the section and its table is sound
[[nodiscard]] std::uint64_t section_offset(std::span<const std::uint8_t> asset, format::SectionId id);

}  // namespace meshlode::test
