// SPDX-License-Identifier: GPL-3.0-or-later
// A group of the pool's clusters as the simplifier takes it.
#pragma once

#include <vector>

#include "base/ids.h"
#include "builder/dag/level_pool.h"
#include "builder/dag/level_use.h"
#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Collects a group's triangles under local ids. Ids of the pool are ascending, and so are the local ones. `shared`:
/// what other groups of the round have too, which stays where it is.
[[nodiscard]] SimplifyInput group_input(const BuildPool& pool, const PreparedMesh& mesh,
                                        const std::vector<ClusterId>& clusters, const Shared& shared);

}  // namespace meshlode::builder
