// SPDX-License-Identifier: GPL-3.0-or-later
// Grid positions as the 32-bit floats of a glTF, and what becomes of a mesh's far-away origin.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "app/export/cut_geometry.h"
#include "base/vec.h"

namespace meshlode::app {

/// The origin that is added to the positions themselves. The origin goes into a node instead where a float32 sum would
/// be off by more than a 64th of a grid step and by more than a float32 mesh of this size centred on zero would be
/// (diagonal · 2^-24): below either, a moved origin would only make the file stranger, not better.
/// All levels of a mesh share it: a viewer puts one in the place of another.
[[nodiscard]] Vec3d choose_origin(const format::MeshRecord& record, std::span<const std::vector<CutPrimitive>> levels);

/// baked + the grid's positions, rounded once; nothing where one is not finite as a float.
[[nodiscard]] std::optional<std::vector<Vec3f>> bake_positions(const format::MeshRecord& record,
                                                               const run::DecodedCluster& vertices, const Vec3d& baked);

}  // namespace meshlode::app
