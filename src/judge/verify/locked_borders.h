// SPDX-License-Identifier: GPL-3.0-or-later
// V114: the open border of a source whose borders are locked (docs/reference/format.md, "The open border") is in every
// cut, vertex by vertex. Decided group by group, as the border proof is, and looked at once more on random cuts.
// Internal to the judge.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec.h"
#include "judge/metrics/triangle_corners.h"
#include "judge/validate/rules.h"
#include "judge/validate/surface.h"
#include "judge/verify/triangle_key.h"

namespace meshlode::judge {

/// The vertices of the open border, by exact position, ascending, each once. `drawn`: the triangles of the source, over
/// all primitives, without those that are no part of it.
[[nodiscard]] std::vector<Vec3d> find_open_border(const TriangleCorners& drawn);

struct LockedTotals {
  std::uint64_t meshes = 0, vertices = 0;  ///< whose borders are locked; the grid points of these
  std::uint64_t groups = 0, cuts = 0;      ///< looked at
};

/// V114 for one mesh. `border`: the grid points of find_open_border(), in any order.
void check_locked_border(const run::Asset& asset, const MeshSurface& surface, const std::vector<GridPoint>& border,
                         LockedTotals& totals, RuleLog& log);

}  // namespace meshlode::judge
