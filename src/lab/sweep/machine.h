// SPDX-License-Identifier: GPL-3.0-or-later
// The machine in words: measured times are worth nothing without it.
#pragma once

#include <cstdint>
#include <string>

namespace meshlode::lab {

struct MachineFacts {
  std::string processor;  ///< as it names itself
  std::string system;     ///< "Linux 6.1.0"
  std::uint32_t threads = 0;
  std::uint64_t memory_bytes = 0;
};
[[nodiscard]] MachineFacts describe_machine();

}  // namespace meshlode::lab
