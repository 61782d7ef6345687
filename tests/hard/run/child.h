// SPDX-License-Identifier: GPL-3.0-or-later
// A trial in a process of its own, so that a crash, a hang or a flood of memory is a verdict like any other.
#pragma once

#include <string>
#include <vector>

namespace meshlode::test::hard {

struct ChildLimits {
  double cpu_seconds = 60.0;
  double wall_seconds = 240.0;
  std::size_t memory_bytes = std::size_t{8} << 30U;  ///< of addresses; 0: no limit
};

struct ChildResult {
  int exit_code = -1;  ///< -1 where a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string out;
};

/// Runs the program with these arguments; what it prints to stdout comes back.
[[nodiscard]] ChildResult run_child(const std::string& program, std::vector<std::string> arguments,
                                    const ChildLimits& limits);

}  // namespace meshlode::test::hard
