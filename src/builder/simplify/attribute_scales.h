// SPDX-License-Identifier: GPL-3.0-or-later
// What attributes weigh against distance.
#pragma once

#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Per float of a wedge, the factor that makes its stored value a distance in the group's frame: see SimplifyOptions. 0
/// where it does not count.
[[nodiscard]] std::vector<double> attribute_scales(const SimplifyInput& input, const SimplifyOptions& options,
                                                   const CollapseMesh& mesh, const GroupPlaces& places);

}  // namespace meshlode::builder
