// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/work/warnings.h"

#include "base/printable.h"
#include "scene/detect/fault.h"

namespace meshlode::app {

namespace {

std::string why_nothing_is_drawn(const JobFacts& facts) {
  const std::string triangles = grouped_digits(facts.triangles);
  if (facts.triangles == 1) return "its one triangle has no area";
  if (facts.triangles > 1) return "none of its " + triangles + " triangles has an area";
  if (facts.dropped > 0) return "--repair removed every triangle, " + grouped_digits(facts.dropped) + " in all";
  if (facts.missing > 0) return "no triangle could be read";
  return "it has no triangle";
}

}  // namespace

std::vector<JobWarning> list_warnings(const JobFacts& facts) {
  std::vector<JobWarning> warnings;
  if (facts.draws_nothing) {
    warnings.push_back({name_of(scene::FaultKind::kNothingToDraw), "nothing to draw: " + why_nothing_is_drawn(facts)});
  }
  if (facts.missing > 0) {
    warnings.push_back({name_of(scene::FaultKind::kMissing), "triangles are missing: " + grouped_digits(facts.missing) +
                                                                 " of the " + grouped_digits(facts.file_triangles) +
                                                                 " that the file holds"});
  }
  return warnings;
}

}  // namespace meshlode::app
