// SPDX-License-Identifier: GPL-3.0-or-later
// Export: a cut of an asset as a GLB that keeps nodes, names, instances, materials and textures.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/result.h>

#include "base/ids.h"
#include "read/asset.h"

namespace meshlode {

/// One cut per mesh of the asset (an empty cut leaves the mesh without primitives and its nodes without mesh).
/// Positions that are one grid point become one vertex wherever their attributes agree.
[[nodiscard]] Result<std::vector<std::uint8_t>> export_glb(const Asset& asset,
                                                           std::span<const std::vector<ClusterId>> cut_per_mesh);

}  // namespace meshlode
