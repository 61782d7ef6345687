// SPDX-License-Identifier: GPL-3.0-or-later
// What an asset's tables and META say of the source it was made from, as diagnoses.
#pragma once

#include <string>
#include <vector>

#include "app/doctor/diagnosis.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// Ids of all that diagnose_asset() may find, in one order.
[[nodiscard]] std::vector<std::string> asset_fault_ids();

/// The cases of docs/reference/hard-cases.md that these name.
[[nodiscard]] std::vector<std::string> asset_hard_cases();

/// Not ranked. Stuck groups by reason, the few groups that hold the error, dropped and collapsed triangles, meshes of
/// one cluster, errors that were never measured, what was left out. Reads no page.
[[nodiscard]] std::vector<Diagnosis> diagnose_asset(const run::Asset& asset);

}  // namespace meshlode::app
