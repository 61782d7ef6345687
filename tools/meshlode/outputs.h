// SPDX-License-Identifier: GPL-3.0-or-later
// The files that this process writes, and how it ends when it is asked to.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <meshlode/result.h>

#include "base/output_files.h"

namespace meshlode::cli {

/// The one list of what the command has read and written: one process is one command.
[[nodiscard]] OutputFiles& output_files();

/// Writes text to a file of output_files().
[[nodiscard]] Status write_text(const std::string& path, const std::string& text);

/// From here on SIGINT, SIGTERM and SIGHUP end the process with one line on stderr, exit code 2 and no temporary file
/// left; those that the caller made the process ignore stay ignored. A pipe that nobody reads and a limit on file sizes
/// are errors of the write, not the end of the process. Call it before any thread is started.
void watch_signals();

}  // namespace meshlode::cli
