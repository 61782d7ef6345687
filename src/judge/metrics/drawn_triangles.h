// SPDX-License-Identifier: GPL-3.0-or-later
// Which triangles of a source belong into level 0, by the definition of docs/reference/format.md ("The source"): those
// with area, and those without that lie along edges of these. Internal to the judge.
#pragma once

#include <cstdint>
#include <vector>

#include "judge/metrics/triangle_corners.h"

namespace meshlode::judge {

/// Per triangle 1 if it belongs into level 0. `triangles` are corners as the file has them. O(n log n).
[[nodiscard]] std::vector<std::uint8_t> find_drawn(const TriangleCorners& triangles);

}  // namespace meshlode::judge
