// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace meshlode::fuzz {

/// What the harness `stored` (stored.cpp) reads, by name.
[[nodiscard]] std::vector<std::pair<std::string, std::vector<std::uint8_t>>> make_stored_seeds();

}  // namespace meshlode::fuzz
