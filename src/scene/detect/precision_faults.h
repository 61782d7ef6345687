// SPDX-License-Identifier: GPL-3.0-or-later
// Faults of positions that the numbers which hold them are too coarse for. Each function looks for one; `count` 0:
// none.
#pragma once

#include "scene/detect/fault.h"
#include "scene/detect/topology.h"

namespace meshlode::scene {

/// Triangles, slivers apart, whose corners fall on one point or line of the position grid that a build chooses where it
/// is not told one: a mesh of bolts and the bridge that they hold. Where they are one of a hundred or more.
[[nodiscard]] Fault find_finer_than_grid(const Topology& topology);

/// Where floats leave an edge of the median length fewer than 256 steps, at a distance of 4 diagonals and more.
[[nodiscard]] Fault find_far_from_origin(const Topology& topology);

}  // namespace meshlode::scene
