// SPDX-License-Identifier: GPL-3.0-or-later
// The errors of the tier `measured` against whole cuts: a second look that knows nothing of how the first was taken.
//
// While a DAG is built a group is measured by the samples that were handed to it. Where a mesh falls into many thin
// pieces that cross each other, a piece that went may have no sample left, and no neighbour leads to it. Here points of
// all of the source are held against cuts of all of the mesh, so that nothing depends on who was handed what.
#pragma once

#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Raises `deviation` and `error` of groups that are farther from some point of the source than their error says, and
/// of what is coarser (I4). Most DAGs come back as they are. Looks at the coarsest cuts, group by group, then in steps
/// of an eighth of the groups, as long as the cuts together have no more triangles than the mesh, or than a few hundred
/// thousand. \returns how many groups were raised. The same for any thread count (I10).
std::size_t hold_to_whole_cuts(const PreparedMesh& mesh, double margin, LodDag& dag);

}  // namespace meshlode::builder
