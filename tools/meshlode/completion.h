// SPDX-License-Identifier: GPL-3.0-or-later
// Completion scripts for shells, made from the verbs' options.
#pragma once

#include <span>
#include <string>

#include "option_table.h"

namespace meshlode::cli {

/// Bash 4 or newer. Completes verbs, their options, and values where there are only some; file names elsewhere.
[[nodiscard]] std::string bash_completion(std::span<const VerbHelp> verbs);
/// zsh: as an autoloaded function `_meshlode` or by `source`. Shows what each option is for.
[[nodiscard]] std::string zsh_completion(std::span<const VerbHelp> verbs);
/// fish 3 or newer.
[[nodiscard]] std::string fish_completion(std::span<const VerbHelp> verbs);

}  // namespace meshlode::cli
