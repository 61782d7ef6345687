// SPDX-License-Identifier: GPL-3.0-or-later
// `--fail-if CONDITIONS` (docs/compare.md): budgets over the keys of `info`, and of `compare` over its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "options.h"
#include "out/budget/judge_budget.h"

namespace meshlode::cli {

void add_budget_option(OptionParser& parser, std::string& conditions);

/// One line on stderr for each condition. \returns the exit code, 0 where none is broken
int print_broken(const std::string& where, const std::vector<out::BrokenCondition>& broken);

/// The asset of this file against conditions over `info`. Errors: kCheckFailed with all conditions that hold; those of
/// opening the file.
[[nodiscard]] Status check_asset_budget(const std::filesystem::path& path,
                                        const std::vector<out::Condition>& conditions);

}  // namespace meshlode::cli
