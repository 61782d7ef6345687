// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/gpu/stream_requests.h"

#include <algorithm>
#include <cmath>

#include <meshlode/format.h>

#include "judge/validate/rules.h"

namespace meshlode::judge {

namespace {

/// A device's division and square root are not exact, and the distance to a near sphere is what two floats leave that
/// are nearly equal.
constexpr double kPriorityDifference = 0.01;

}  // namespace

std::string find_priority_fault(std::span<const float> device, std::span<const float> host, double pixel_error) {
  for (std::size_t page = 0; page < device.size(); ++page) {
    const double got = double{device[page]} * (device[page] < format::kInfiniteError ? pixel_error : 1.0);
    const double want = page < host.size() ? double{host[page]} : 0.0;
    // Without an error allowed the device has no measure, and the CPU goes by one pixel.
    if (pixel_error == 0.0 && (device[page] > 0.0F) == (want > 0.0)) continue;
    if (std::fabs(got - want) <= kPriorityDifference * want) continue;
    return differs(place("page", page) + ": the device asks by", got, "the CPU by", want);
  }
  return {};
}

std::string find_culled_fault(const DrawnFrame& culled, const DrawnFrame& whole) {
  if (!std::includes(whole.cut.begin(), whole.cut.end(), culled.cut.begin(), culled.cut.end())) {
    return "culled, a cluster is drawn that is not of the cut";
  }
  for (std::size_t page = 0; page < whole.priorities.size(); ++page) {
    if (culled.priorities[page] <= whole.priorities[page]) continue;
    return differs(place("page", page) + ": culled, the device asks by", double{culled.priorities[page]}, "else by",
                   double{whole.priorities[page]});
  }
  return {};
}

std::string find_unasked_page(std::span<const float> priorities, std::span<const std::uint32_t> seen) {
  for (const std::uint32_t page : seen) {
    if (!(priorities[page] > 0.0F)) {
      return place("page", page) + " would be seen, and culled the device does not ask for it";
    }
  }
  return {};
}

}  // namespace meshlode::judge
