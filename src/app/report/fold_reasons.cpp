// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/fold_reasons.h"

#include <map>
#include <utility>

namespace meshlode::app {

namespace {

/// Of a mesh's reason what stands behind its name; empty for others. A name may hold anything, what is kept no ": ".
std::string thing_of_mesh(const std::string& what) {
  const std::size_t at = what.rfind(": ");
  return what.starts_with("mesh ") && at != std::string::npos ? what.substr(at + 2) : std::string();
}

}  // namespace

std::vector<Reason> fold_reasons(std::span<const Reason> reasons, std::size_t mesh_count) {
  std::map<std::pair<std::string, std::string>, std::size_t> counts;
  for (const Reason& reason : reasons) ++counts[{thing_of_mesh(reason.what), reason.why}];
  std::vector<Reason> folded;
  for (const Reason& reason : reasons) {
    const std::string thing = thing_of_mesh(reason.what);
    std::size_t& count = counts[{thing, reason.why}];
    if (count == 0) continue;  // folded before
    if (thing.empty() || count == 1) {
      folded.push_back(reason);
      continue;
    }
    folded.push_back(
        {thing + ", " + std::to_string(count) + " of " + std::to_string(mesh_count) + " meshes", reason.why});
    count = 0;
  }
  return folded;
}

}  // namespace meshlode::app
