// SPDX-License-Identifier: GPL-3.0-or-later
// The errors of a finished DAG's groups, from its geometry and the source alone: the tier `measured`.
#pragma once

#include "builder/deviation/deviation.h"
#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Fills deviation, error, normal_deviation and uv_deviation of every group that is not terminal. The mesh has its
/// exact triangles, and `source` is the tree over them. `form` is the DAG's, whose triangles are in its order;
/// level0_of_source is freed. `margin` >= 1: an error is so many times what was found.
void measure_levels(const PreparedMesh& mesh, SourceTree source, CanonicalForm& form, double margin, LodDag& dag);

}  // namespace meshlode::builder
