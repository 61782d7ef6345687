// SPDX-License-Identifier: GPL-3.0-or-later
// Manual pages (roff, macros of man(7)), made from the verbs' options. Equal programs write equal bytes: a page has the
// version, and no date.
#pragma once

#include <span>
#include <string>

#include "option_table.h"

namespace meshlode::cli {

/// meshlode.1: the verbs, what they have in common, the exit codes. `version` as program_version() says it.
[[nodiscard]] std::string program_man_page(std::span<const VerbHelp> verbs, const std::string& version);
/// meshlode-VERB.1.
[[nodiscard]] std::string verb_man_page(const VerbHelp& verb, std::span<const VerbHelp> verbs,
                                        const std::string& version);

/// "meshlode.1", "meshlode-build.1"; an empty verb is the program.
[[nodiscard]] std::string man_page_name(const std::string& verb);

}  // namespace meshlode::cli
