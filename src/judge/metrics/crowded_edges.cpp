// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge/metrics/crowded_edges.h"

#include <algorithm>
#include <cstddef>

namespace meshlode::judge {

EdgeCounts EdgeCounter::count() {
  std::sort(uses_.begin(), uses_.end());
  EdgeCounts counts;
  for (std::size_t first = 0; first < uses_.size();) {
    std::size_t last = first;
    std::int64_t net = 0;
    for (; last < uses_.size() && uses_[last] >> 1U == uses_[first] >> 1U; ++last) {
      net += (uses_[last] & 1U) != 0 ? 1 : -1;
    }
    ++counts.edges;
    counts.open += net != 0 ? 1 : 0;
    counts.crowded += last - first > 2 ? 1 : 0;
    first = last;
  }
  uses_.clear();
  return counts;
}

}  // namespace meshlode::judge
