// SPDX-License-Identifier: GPL-3.0-or-later
// What `--version` prints: the program, which build of it this is, and what it stands on.
#pragma once

#include <string>

namespace meshlode::cli {

/// The first line is program_version(); then build id, compiler and format, and a table of libraries. A library that is
/// loaded is asked for its version; others have that of their headers.
[[nodiscard]] std::string version_text();

}  // namespace meshlode::cli
