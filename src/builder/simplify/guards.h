// SPDX-License-Identifier: GPL-3.0-or-later
// Which collapses are refused: those that would break a shared border, the topology, or turn a triangle over.
//
// In all of them b is joined into a, and of two ends the locked one is a: both are never.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/collapse_star.h"
#include "builder/simplify/group_locks.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/wedge_classes.h"

namespace meshlode::builder {

/// I6. An edge between two locked vertices may be one that another group's triangle leans on, so that its uses here
/// stay what they are. A triangle (a, b, tip) goes: where a and its tip are locked, the triangles across (b, tip) must
/// inherit the edge (a, tip). On an open border there may be none: such an ear stays. And an open edge (b, tip) that
/// comes to lie on (a, tip) may not close that one's border. Where a is not locked, all is kept.
[[nodiscard]] bool keeps_shared_edges(const CollapseMesh& mesh, const GroupLocks& locks, const CollapseStar& star);

/// Whether on the grid the star would come to lie where a vertex beside it does, and one of the two is locked. A
/// triangle between them would have no area and go, and the one across would come to a border edge with attributes of
/// its own (I3).
[[nodiscard]] bool falls_together(const GroupLocks& locks, const GroupPlaces& places, const CollapseStar& star);

/// I3 for attributes. A triangle (a, b, c) with a and c locked goes; the triangle across (b, c) inherits the edge
/// (a, c), which may lie on the group's border. If another group shades that edge with the same wedges, the heir must
/// bring them: (b, c) may not be a crease. And no border edge gets a corner with attributes that nothing had there.
/// `classes` are those of the star.
[[nodiscard]] bool keeps_shared_corners(const CollapseMesh& mesh, const GroupLocks& locks, const WedgeClasses& classes,
                                        const CollapseStar& star);

/// The link condition (Dey et al. 1999): common neighbours are exactly the tips of the triangles on the edge, no two
/// triangles become one, and two border vertices join along the border only. `is_border` is per vertex.
[[nodiscard]] bool keeps_topology(const std::vector<std::uint8_t>& is_border, const CollapseStar& star);

/// Whether a triangle that stays would turn by more than 78 degrees with its corner at the target. One without area
/// may: any change of it is for the better. \pre the facets are gathered
[[nodiscard]] bool turns_over(const CollapseStar& star);

}  // namespace meshlode::builder
