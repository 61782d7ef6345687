// SPDX-License-Identifier: GPL-3.0-or-later
// Geometry rules on decoded integers (L116, L501 … L509). Internal to the judge.
#pragma once

#include <span>

#include "run/decode/decode.h"
#include "judge/validate/rules.h"

namespace meshlode {

/// \pre the asset's tables and pages are sound; `clusters` is decode_all of the asset
void check_geometry(const Asset& asset, std::span<const DecodedCluster> clusters, RuleLog& log);

}  // namespace meshlode
