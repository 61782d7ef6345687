// SPDX-License-Identifier: GPL-3.0-or-later
// Unit normals as integer points of an octahedron (Meyer et al. 2010; precise rounding after Cigolle et al. 2014).
#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"

namespace meshlode::builder {

/// The nearest direction to `normal` among the integer points of |X| + |Y| + |Z| = scale. The set is closed under the
/// octahedron's symmetries, so that it is the same seen from each of six charts, and a normal that two clusters share
/// has the same integers in both (I3). The angle to the input is at most sqrt(2) / scale radians.
/// Zero and non-finite normals become +z. \pre scale >= 1
[[nodiscard]] std::array<std::int32_t, 3> nearest_octahedral_point(const Vec3f& normal, std::int32_t scale);

/// The direction of such a point, as long as 1: what readers get, before it is rounded to floats.
[[nodiscard]] Vec3d octahedral_normal(const std::array<std::int32_t, 3>& point);

/// The two stored values, each 0 … 2 · scale, of a point in one of the six charts (docs/reference/format.md, Normals).
/// Where the unfolding has two spellings, the non-negative side is taken.
[[nodiscard]] std::array<std::int32_t, 2> chart_coordinates(const std::array<std::int32_t, 3>& point,
                                                            std::uint32_t chart, std::int32_t scale);

/// The smallest scale whose nearest point is never farther than the angle: ceil(sqrt(2) / angle), at least 1.
/// \pre degrees > 0
[[nodiscard]] std::uint64_t octahedral_scale_for(double degrees);

}  // namespace meshlode::builder
