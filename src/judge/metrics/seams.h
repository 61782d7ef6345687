// SPDX-License-Identifier: GPL-3.0-or-later
// Where an attribute of a surface jumps: edges whose triangles disagree about the value at an end.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "judge/metrics/shaded_surface.h"

namespace meshlode::judge {

/// Per triangle: bit k is set where the edge from corner k to corner k + 1 is a seam of the attribute. Edges are the
/// same where their end positions are; an edge that one triangle has alone is no seam. `value` gives an attribute by
/// vertex index; values differ where they are farther apart than `tolerance`.
[[nodiscard]] std::vector<std::uint8_t> find_seams(const Surface& surface, const std::vector<Vec3f>& values,
                                                   float tolerance);

}  // namespace meshlode::judge
