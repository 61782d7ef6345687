// SPDX-License-Identifier: GPL-3.0-or-later
// How far a collapse's new triangles reach from the old: the other way of left_behind.h.
#pragma once

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_places.h"

namespace meshlode::builder {

/// The largest squared distance from the new triangles' middles, and from those of their edges to the new vertex, to
/// the triangles that they replace; or `enough`, where none is larger. \pre the facets are gathered
[[nodiscard]] float new_surface_distance2(const CollapseMesh& mesh, const GroupPlaces& places, CollapseStar& star,
                                          float enough);

}  // namespace meshlode::builder
