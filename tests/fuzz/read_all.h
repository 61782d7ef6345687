// SPDX-License-Identifier: GPL-3.0-or-later
// Touches all that an asset has, as a program that trusts what Asset and load_page let through would.
#pragma once

#include <cstdint>
#include <span>

#include "run/read/asset.h"

namespace meshlode::fuzz {

void read_all(const run::Asset& asset);
void read_all_c(std::span<const std::uint8_t> bytes);

}  // namespace meshlode::fuzz
