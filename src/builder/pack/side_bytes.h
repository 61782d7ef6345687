// SPDX-License-Identifier: GPL-3.0-or-later
// Heads and ranges of a page's clusters by columns: byte k of every word of a kind lies together.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/pack/page_model.h"

namespace meshlode::builder {

void put_u32(std::vector<std::uint8_t>& out, std::uint32_t value);

/// Counts of the range words, heads, range words: one column after the other. All of them make up the side information.
[[nodiscard]] std::vector<std::vector<std::uint8_t>> make_columns(const format::MeshRecord& mesh,
                                                                  const PageModel& model);

}  // namespace meshlode::builder
