// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry rules on decoded integers (L116, L501 … L509). Internal to the judge.
#pragma once

#include <span>

#include "judge/validate/rules.h"
#include "run/decode/decode.h"

namespace meshlode::judge {

/// \pre the asset's tables and pages are sound; `clusters` is decode_all of the asset
void check_geometry(const run::Asset& asset, std::span<const run::DecodedCluster> clusters, RuleLog& log);

}  // namespace meshlode::judge
