// SPDX-License-Identifier: GPL-3.0-or-later
// The DAG of an aggregate: what thin_mesh() found, as clusters and groups.
#pragma once

#include <span>

#include <meshlode/result.h>

#include "builder/aggregate/pieces.h"
#include "builder/dag/build_dag.h"

namespace meshlode::builder {

/// Every group that is not terminal is an aggregate (DagGroup::is_aggregate). As build_dag_and_free() of the mesh.
/// Errors: kBuildFailed when cancelled.
[[nodiscard]] Result<LodDag> build_aggregate_dag_and_free(PreparedMesh& mesh, std::span<const SourceMaterial> materials,
                                                          const DagOptions& options);

}  // namespace meshlode::builder
