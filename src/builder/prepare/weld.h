// SPDX-License-Identifier: GPL-3.0-or-later
// Welding: vertices that are equal become one, triangles that are equal too, and both get the numbers of a canonical
// order, so that renumbering the input changes nothing.
#pragma once

#include <cstdint>
#include <vector>

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"
#include "builder/prepare/corners.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Fills positions, wedges, exact positions and triangles of `mesh`, and counts duplicates and what the grid collapsed.
/// `points`: the grid point of each vertex that a triangle uses; `is_used`: 1 for those. `keeps_normals`: exact_normals
/// too. \pre layout and origin are set
void weld(const Corners& corners, std::span<const Vec3i> points, const std::vector<std::uint8_t>& is_used,
          bool keeps_normals, PreparedMesh& mesh);

}  // namespace meshlode::builder
