// SPDX-License-Identifier: GPL-3.0-or-later
// OpenMesh's decimater instead of our simplifier, under the same contract (`study --simplifier openmesh`): the
// reference that everybody knows in the same DAG. For studies alone; docs/log/quality.md, "OpenMesh's decimater in the
// same DAG".
#pragma once

#include "builder/simplify/simplify.h"

namespace meshlode::lab {

/// As `builder::simplify_group`, by halfedge collapses: a vertex goes to another one's place, so that positions and
/// attributes are a subset of the input's. Of the options it heeds `target_triangles` and `may_relax_flips`.
[[nodiscard]] builder::SimplifyResult simplify_group_by_openmesh(const builder::SimplifyInput& input,
                                                                 const builder::SimplifyOptions& options);

}  // namespace meshlode::lab
