// SPDX-License-Identifier: MIT
#include "format/page_hint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/float_above.h"

namespace meshlode::format {

PageHintRecord make_page_hint(std::span<const GroupRecord> groups) {
  PageHintRecord hint{};
  for (int axis = 0; axis < 3; ++axis) {  // the middle of the spheres' box
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const GroupRecord& group : groups) {
      low = std::min(low, double{group.center[axis]} - double{group.radius});
      high = std::max(high, double{group.center[axis]} + double{group.radius});
    }
    hint.center[axis] = static_cast<float>(0.5 * (low + high));
  }
  double reach = 0.0;
  for (const GroupRecord& group : groups) {
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double away = double{group.center[axis]} - double{hint.center[axis]};
      square += away * away;
    }
    reach = std::max(reach, std::sqrt(square) + double{group.radius});
  }
  // A dozen roundings, each by 2^-53: with this the sphere contains the others exactly.
  hint.radius = float_above(reach * (1.0 + 0x1p-40));
  const auto [least, most] = std::minmax_element(
      groups.begin(), groups.end(), [](const GroupRecord& a, const GroupRecord& b) { return a.error < b.error; });
  hint.smallest_error = least->error;
  hint.largest_error = most->error;
  return hint;
}

}  // namespace meshlode::format
