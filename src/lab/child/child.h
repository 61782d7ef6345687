// SPDX-License-Identifier: GPL-3.0-or-later
// One run of a program in a process of its own, with what it took.
//
// Builds that are measured run so: the processor time and the high-water mark of memory that the kernel counts are
// then those of one build alone, no build finds memory, threads or caches as another has left them, and one that is
// killed for its memory is a failed measurement, not the end of the sweep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <meshlode/result.h>

namespace meshlode::lab {

struct ChildRun {
  int exit_code = 0;  ///< 128 + the signal's number where one ended it
  double wall_seconds = 0.0;
  double user_seconds = 0.0, system_seconds = 0.0;  ///< of all its threads
  std::uint64_t peak_bytes = 0;                     ///< high-water mark of what was resident, read every 10 ms
  std::string errors;                               ///< the end of what it wrote to stderr, at most 4 KiB
};

/// Runs the program and waits. Its stdin and stdout are /dev/null. It is told to end where this process ends before it.
/// Errors: kIo where it could not be started.
[[nodiscard]] Result<ChildRun> run_child(const std::filesystem::path& program, std::span<const std::string> arguments);

}  // namespace meshlode::lab
