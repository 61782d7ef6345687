// SPDX-License-Identifier: MIT
// Floats that bound doubles from above.
#pragma once

#include <cmath>
#include <limits>

namespace meshlode {

/// The smallest float that is not below `value`; at most the largest finite one, which is how the format says infinite.
/// \pre value >= 0 or NaN (the largest then)
[[nodiscard]] inline float float_above(double value) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  if (!(value < double{kLargest})) return kLargest;
  const auto nearest = static_cast<float>(value);
  return double{nearest} < value ? std::nextafter(nearest, kLargest) : nearest;
}

}  // namespace meshlode
