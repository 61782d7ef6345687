// SPDX-License-Identifier: GPL-3.0-or-later
// Unit normals as integer points of an octahedron (Meyer et al. 2010; precise rounding after Cigolle et al. 2014).
#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"

namespace meshlode {

/// The two stored values, each 0 … 2^bits - 2, of the representable direction that lies nearest to `normal`.
///
/// The representable directions are the integer points of |X| + |Y| + |Z| = M with M = 2^(bits-1) - 1. Each has exactly
/// one pair of values: where the unfolding of the lower half has two, the non-negative side is taken. So equal
/// directions have equal integers (I3). The angle to the input is at most sqrt(2) / M radians.
/// Zero and non-finite normals become +z.
[[nodiscard]] std::array<std::int32_t, 2> encode_octahedral(const Vec3f& normal, std::uint32_t bits);

}  // namespace meshlode
