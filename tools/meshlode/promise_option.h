// SPDX-License-Identifier: GPL-3.0-or-later
// `--promise`: which of an asset's errors a cut is chosen by.
#pragma once

#include <string>

#include <meshlode/result.h>

#include "options.h"
#include "run/read/asset.h"

namespace meshlode::cli {

void add_promise_option(OptionParser& parser, std::string& promise);

/// Errors: kUnsupported, with how to build one, where the asset does not promise that. \pre one of the parser's words
[[nodiscard]] Status choose_promise(const std::string& promise, run::Asset& asset);

}  // namespace meshlode::cli
