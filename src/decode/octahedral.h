// SPDX-License-Identifier: MIT
// Octahedral normals: two integers name an integer point of |X| + |Y| + |Z| = M, the normal is its direction.
#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"

namespace meshlode {

/// The integer point of stored values a and b. Integer arithmetic only, so it is the same everywhere (I9).
[[nodiscard]] std::array<std::int32_t, 3> decode_octahedral_point(std::int32_t a, std::int32_t b, std::uint32_t bits);

/// The unit normal: each coordinate divided by the square root of the sum of squares, in double, rounded to float once.
[[nodiscard]] Vec3f decode_octahedral(std::int32_t a, std::int32_t b, std::uint32_t bits);

}  // namespace meshlode
