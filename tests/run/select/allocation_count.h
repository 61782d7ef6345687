// SPDX-License-Identifier: GPL-3.0-or-later
// How often the test program took memory from the heap: its operator new counts.
#pragma once

#include <cstdint>

namespace meshlode::test {

[[nodiscard]] std::uint64_t allocation_count();

}  // namespace meshlode::test
