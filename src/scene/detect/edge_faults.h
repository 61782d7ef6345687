// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of how sound triangles meet. Each function looks for one; `count` 0: none.
#pragma once

#include "scene/detect/fault.h"
#include "scene/detect/topology.h"

namespace meshlode::scene {

[[nodiscard]] Fault find_non_manifold_edges(const Topology& topology);

/// Concerned are, in each piece of surface, the triangles that face as the fewer do; of a piece that cannot be oriented
/// those at the edges where it meets itself the wrong way.
[[nodiscard]] Fault find_misoriented(const Topology& topology);

/// Points of border edges that lie within a ten-thousandth of the diagonal, and a tenth of the median border edge, of
/// another one that no edge joins them with: where they are one of a hundred points of borders or more.
[[nodiscard]] Fault find_unwelded_seams(const Topology& topology);

}  // namespace meshlode::scene
