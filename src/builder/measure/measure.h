// SPDX-License-Identifier: GPL-3.0-or-later
// How far a finished DAG is from its source. Nothing of the DAG's geometry depends on it: build_dag() first makes all
// triangles, then measure() finds the errors of its groups, once.
#pragma once

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// A search finds a maximum from below. In the tier kMeasured an error is the deviation that it found times this.
/// Chosen on one set of scenes and reported on another: docs/log/quality.md, "How true the stored errors are".
constexpr double kMeasuredMargin = 1.02;

/// Sets error, deviation, normal_deviation and uv_deviation of the groups that are not terminal, in object units,
/// degrees and UV units; errors never fall from fine to coarse (I4). Where errors come from (I7,
/// docs/reference/invariants.md):
///   kQem        the simplifier's own estimate, as the file stores it
///   kMeasured   the largest distance that was met between each level's whole surface and the source (measure_levels.h)
///   kCertified  an upper bound of the deviation
/// In a mesh of several materials the errors of kMeasured and kCertified are no less than its materials have moved
/// (material_errors.h). A group of an aggregate (DagGroup::is_aggregate) keeps what its coverage is off by, with the
/// tier's margin.
///
/// What comes of it depends on the DAG's triangles alone, in whatever order they lie within their clusters
/// (canonical_form()): what an asset decodes to gets the errors that its build had. Attributes are to be as they are
/// stored (snap_attributes()). The same for any thread count (I10).
///
/// Errors: kCheckFailed where the DAG's level 0 is another surface than the mesh's; cannot be of a DAG made from it.
/// kUnsupported for 2^32 vertices and more.
///
/// \pre `mesh` has its frame, its layout and, unless the tier is kQem, its exact triangles
[[nodiscard]] Status measure(const PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag);
/// And frees the exact triangles: each part of them as soon as nothing needs it.
[[nodiscard]] Status measure_and_free(PreparedMesh& mesh, format::ErrorTier tier, LodDag& dag);

}  // namespace meshlode::builder
