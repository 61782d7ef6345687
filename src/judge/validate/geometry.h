// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry rules on decoded integers (L116, L501 … L509). Internal to the judge.
#pragma once

#include <meshlode/result.h>

#include "judge/validate/rules.h"
#include "run/read/asset.h"

namespace meshlode::judge {

/// Clusters are decoded one by one. Error: of the first page that the reader refuses. \pre the asset's tables and pages
/// are sound
[[nodiscard]] Status check_geometry(const run::Asset& asset, RuleLog& log);

}  // namespace meshlode::judge
