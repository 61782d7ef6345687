// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of an asset as its build had it before its groups were measured.
#pragma once

#include <meshlode/result.h>

#include "base/ids.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "run/read/asset.h"

namespace meshlode::app {

/// Error: kInvalid where a UV set is said to be one that no scene has.
[[nodiscard]] Result<builder::AttributeLayout> layout_of(const format::MeshRecord& mesh);

/// Errors: kInvalid where nothing is made of a group that is not terminal; those of load_page().
[[nodiscard]] Result<builder::LodDag> read_dag(const run::Asset& asset, MeshId mesh,
                                               const builder::AttributeLayout& layout);

}  // namespace meshlode::app
