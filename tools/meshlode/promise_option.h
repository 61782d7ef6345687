// SPDX-License-Identifier: GPL-3.0-or-later
// `--promise`: which of an asset's errors a cut is chosen by.
#pragma once

#include <string>

#include <meshlode/result.h>

#include "options.h"
#include "run/read/asset.h"

namespace meshlode::cli {

void add_promise_option(OptionParser& parser, std::string& promise);

/// The asset by that promise. Errors: kUnsupported, with how to build one, where it has none. \pre one of the parser's
/// words
[[nodiscard]] Result<run::Asset> with_promise(const run::Asset& asset, const std::string& promise);

}  // namespace meshlode::cli
