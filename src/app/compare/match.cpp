// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/compare/match.h"

#include <algorithm>
#include <map>

namespace meshlode::app {

Matches match_by_name(const std::vector<std::string_view>& before, const std::vector<std::string_view>& after) {
  struct Places {
    std::vector<std::size_t> at;  ///< in the old list
    std::size_t taken = 0;
  };
  std::map<std::string_view, Places> places;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!before[i].empty()) places[before[i]].at.push_back(i);
  }
  Matches matches;
  std::vector<bool> is_old_matched(before.size(), false), is_new_matched(after.size(), false);
  const auto pair = [&](std::size_t old_index, std::size_t new_index) {
    matches.pairs.emplace_back(old_index, new_index);
    is_old_matched[old_index] = true;
    is_new_matched[new_index] = true;
  };
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto found = places.find(after[i]);
    if (found == places.end() || found->second.taken == found->second.at.size()) continue;
    pair(found->second.at[found->second.taken++], i);
  }
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    if (!is_old_matched[i] && !is_new_matched[i]) pair(i, i);
  }
  std::sort(matches.pairs.begin(), matches.pairs.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!is_old_matched[i]) matches.removed.push_back(i);
  }
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (!is_new_matched[i]) matches.added.push_back(i);
  }
  return matches;
}

}  // namespace meshlode::app
