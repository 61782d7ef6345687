// SPDX-License-Identifier: GPL-3.0-or-later
// Needles: triangles far longer than a grid cell and narrower than one. Where two of their corners fall into one cell
// the triangle would become a segment, which nothing draws, and what only it reached would be lost for good at level 0:
// no simplifier can put off what the grid has done already, and the loss is every coarser level's error.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "format/grid.h"

namespace meshlode::builder {

/// Moves, where it can, one of the two corners to the free neighbouring cell that it is nearest to. No vertex gets
/// farther from where it was than half a cell's diagonal, which is the grid's own bound, and vertices that were equal
/// stay equal. The outcome does not depend on the order of vertices or triangles. Returns how many needles were kept
/// so.
///
/// `positions` are relative to the grid's origin, in object units; `triangles` holds three vertex ids each; `cells` is
/// the grid point of each vertex that a triangle uses.
std::uint64_t separate_needles(std::span<const Vec3d> positions, std::span<const std::uint32_t> triangles,
                               const format::PositionGrid& grid, std::span<Vec3i> cells);

}  // namespace meshlode::builder
