// SPDX-License-Identifier: GPL-3.0-or-later
// `meshlode extract --stuck`: the groups where simplification is stuck, coloured by reason.
#pragma once

#include "bulk.h"
#include "options.h"
#include "run/read/asset.h"

namespace meshlode::cli {

/// Writes the GLB and tells what is in it.
[[nodiscard]] FileOutcome extract_stuck(const run::Asset& asset, const std::string& output,
                                        const OutputOptions& options);

}  // namespace meshlode::cli
