// SPDX-License-Identifier: GPL-3.0-or-later
// `--fail-if CONDITIONS` (docs/guides/budgets.md): budgets over the keys of `info`, and of `compare` over its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "app/budget/judge_budget.h"
#include "options.h"

namespace meshlode::cli {

/// `keys`: where the keys are to be looked up, `example`: conditions over them, for the help.
void add_budget_option(OptionParser& parser, std::optional<std::string>& conditions, const std::string& keys,
                       const std::string& example);

/// app::read_budget() of what was given; no conditions where nothing was. Errors: kUsage, for an empty text too: a
/// pipeline whose variable is unset must not pass for one whose budget holds.
[[nodiscard]] Result<std::vector<app::Condition>> read_budget_option(const std::optional<std::string>& conditions,
                                                                     std::string_view schema);

/// One line on stderr for each condition. \returns the exit code, 0 where none is broken
int print_broken(const std::string& where, const std::vector<app::BrokenCondition>& broken);

/// The asset of this file against conditions over `info`. Errors: kCheckFailed with all conditions that hold; those of
/// opening the file, of which at most so many bytes are decoded.
[[nodiscard]] Status check_asset_budget(const std::filesystem::path& path,
                                        const std::vector<app::Condition>& conditions, std::uint64_t max_decoded);

}  // namespace meshlode::cli
