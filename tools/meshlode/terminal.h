// SPDX-License-Identifier: GPL-3.0-or-later
// What stdout can show.
#pragma once

namespace meshlode::cli {

/// Whether stdout is a terminal whose locale (LC_ALL, LC_CTYPE or LANG) is UTF-8. In a pipe or a file never: what is
/// written there must not depend on who is looking.
[[nodiscard]] bool is_unicode_terminal();

}  // namespace meshlode::cli
