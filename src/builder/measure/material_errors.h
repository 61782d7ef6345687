// SPDX-License-Identifier: GPL-3.0-or-later
// How far materials move along the DAG: a deviation alone does not tell a wall from the panes that took its place.
#pragma once

#include <vector>

#include "builder/lod_dag.h"
#include "builder/measure/canonical_form.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Per group, object units; none where the mesh has one material. A group replaces pieces: triangles of one material
/// that hang together by their corners. Where a triangle is farther than some distance from what the group made of the
/// same material, it is lost at that distance. A piece is off by the largest distance x beyond which it loses an area
/// of x², so by no more than the root of its own area, and the group's extent; the group is off by its worst piece.
///
/// From fine to coarse the squares add up, because what one level moves has nothing to do with what the next one does.
/// This is an estimate: MaterialErrors.AreCloseToWhatAllOfTheSourceIsOffBy says how good a one.
///
/// The same for any thread count. \pre the DAG's triangles are in the order of `form`
[[nodiscard]] std::vector<double> material_errors(const PreparedMesh& mesh, const CanonicalForm& form,
                                                  const LodDag& dag);

}  // namespace meshlode::builder
