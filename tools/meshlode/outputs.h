// SPDX-License-Identifier: GPL-3.0-or-later
// The files that this process writes, and how it ends when it is asked to.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include <meshlode/result.h>

#include "base/output_files.h"

namespace meshlode::cli {

/// The one list of what the command has read and written: one process is one command. Folders of its outputs that are
/// missing are made as these are written.
[[nodiscard]] OutputFiles& output_files();

/// A file that was read, if it is there: no output replaces it.
void keep_file(const std::filesystem::path& path);

/// Writes text to a file of output_files().
[[nodiscard]] Status write_text(const std::string& path, const std::string& text);

/// From here on SIGINT, SIGTERM and SIGHUP end the process with one line on stderr, exit code 2 and no temporary file
/// left; those that the caller made the process ignore stay ignored. A pipe that nobody reads and a limit on file sizes
/// are errors of the write, not the end of the process. Call it before any thread is started.
void watch_signals();

/// Called where such a signal ends the process, before its temporary files are removed, by another thread than the
/// caller's; empty: nothing more is done. Once this has returned, the action that was there before is not under way.
void set_interrupt_action(std::function<void()> action);

/// From here on memory that runs out where nothing may be thrown (a library's destructor that allocates) ends the
/// process as it does elsewhere: one line on stderr, exit code 4 and no temporary file left.
void end_where_memory_runs_out();

}  // namespace meshlode::cli
