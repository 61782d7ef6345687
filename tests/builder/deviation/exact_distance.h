// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL in exact arithmetic, as an oracle for what doubles lose.
#pragma once

#include "builder/deviation/point_distance.h"

namespace meshlode::test {

/// Whether a point is within a distance of a triangle, without any rounding. \pre the triangle has area
[[nodiscard]] bool is_within_exactly(const Vec3d& point, const builder::TriangleCorners& triangle, double distance);

}  // namespace meshlode::test
