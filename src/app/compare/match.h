// SPDX-License-Identifier: GPL-3.0-or-later
// Which entry of an old list is which of a new one.
#pragma once

#include <cstddef>
#include <string_view>
#include <utility>
#include <vector>

namespace meshlode::app {

struct Matches {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< (old, new), ascending by the new one
  std::vector<std::size_t> removed;                        ///< of the old list, ascending
  std::vector<std::size_t> added;                          ///< of the new list, ascending
};

/// By name first, the n-th of a name being the n-th of it; of what is left, unnamed or renamed, those at the same
/// index. O(n log n).
[[nodiscard]] Matches match_by_name(const std::vector<std::string_view>& before,
                                    const std::vector<std::string_view>& after);

}  // namespace meshlode::app
