// SPDX-License-Identifier: GPL-3.0-or-later
// Heads and ranges of a page's clusters by columns: byte k of every word of a kind lies together.
#pragma once

#include <cstdint>
#include <vector>

#include "pack/page_model.h"

namespace meshlode {

void put_u32(std::vector<std::uint8_t>& out, std::uint32_t value);

/// Counts of the range words, heads, range words: what every method's side information ends with.
void put_columns(const format::MeshRecord& mesh, const PageModel& model, std::vector<std::uint8_t>& out);

}  // namespace meshlode
