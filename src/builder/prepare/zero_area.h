// SPDX-License-Identifier: GPL-3.0-or-later
// What the source is: the points of its triangles that have area (docs/reference/format.md, "The source"). A triangle
// whose corners lie on one line draws nothing. Where it lies along edges of triangles with area it closes a T-junction
// and adds no point: it stays, or the surface would be open there (I6). Any other one is no part of the source.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace meshlode::builder {

/// Whether three points lie on one line, decided exactly. \pre all finite
[[nodiscard]] bool are_collinear(const Vec3d& a, const Vec3d& b, const Vec3d& c);

/// Per triangle 1 if it has no area and does not lie along edges of triangles that have: two corners at one position,
/// or three on one line whose longest edge is not covered. Edges of triangles with area are covered; so are the two
/// short edges of a triangle without area whose long one is, and the long one if both short ones are. Edges are told
/// apart by the exact positions of their ends. `triangles` holds three vertex ids each. O(n log n). \pre positions in
/// use are finite
[[nodiscard]] std::vector<std::uint8_t> find_undrawn(std::span<const Vec3d> positions,
                                                     std::span<const std::uint32_t> triangles);

}  // namespace meshlode::builder
