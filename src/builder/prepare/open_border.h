// SPDX-License-Identifier: GPL-3.0-or-later
// The open border of a source mesh, for builds that lock it: docs/reference/format.md, "The open border", defines it.
// Tiles that are built apart share the vertices of theirs, so these are found by exact position, over all primitives:
// what the grid does to a tile's other triangles changes nothing.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/prepare/corners.h"

namespace meshlode::builder {

/// Per position of a mesh 1 where a vertex of the border lies. An edge is of the border where one triangle has it;
/// copies with the same corners in the same order count once. `points`: the grid point of each vertex that a triangle
/// uses; `is_used`: 1 for those; `positions`: the mesh's, those points each once. O(n log n). \pre positions in use are
/// finite, and triangles that are no part of the source are gone
[[nodiscard]] std::vector<std::uint8_t> find_open_border(const Corners& corners,
                                                         const std::vector<std::uint8_t>& is_used,
                                                         std::span<const Vec3i> points,
                                                         std::span<const Vec3i> positions);

}  // namespace meshlode::builder
