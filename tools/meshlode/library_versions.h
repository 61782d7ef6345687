// SPDX-License-Identifier: GPL-3.0-or-later
// What `--version` prints: the program, which build of it this is, and what it stands on.
#pragma once

#include <string>

#include "app/batch/tell/tell.h"

namespace meshlode::cli {

/// The first line is program_version(); then build id, compiler and format, and a table of libraries. A library that is
/// loaded is asked for its version; others have that of their headers.
[[nodiscard]] std::string version_text();

/// Name and version of each library of that table, of the format, and of the compiler.
[[nodiscard]] app::Versions library_versions();

}  // namespace meshlode::cli
