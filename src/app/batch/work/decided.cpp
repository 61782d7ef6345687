// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/batch/work/decided.h"

#include <cstddef>
#include <map>
#include <utility>

#include "builder/aggregate/aggregate_choice.h"
#include "format/names.h"

namespace meshlode::app {

std::string describe_decided(const builder::PipelineOptions& options,
                             std::span<const builder::PlanDecision> decisions) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> attributes;  // meshes that keep it, and that do not
  std::size_t aggregates = 0;
  for (const builder::PlanDecision& decision : decisions) {
    if (!decision.attribute.empty()) {
      auto& [kept, left_out] = attributes[decision.attribute];
      ++(decision.kept ? kept : left_out);
    }
    if (decision.kept && decision.what.ends_with(": aggregate")) ++aggregates;
  }
  std::string text = "attributes ";
  bool is_first = true;
  for (const auto& [name, meshes] : attributes) {
    if (meshes.first == 0) continue;
    text += (is_first ? "" : ", ") + name + (meshes.second > 0 ? " of some meshes" : "");
    is_first = false;
  }
  if (is_first) text += "none but positions";
  text += "; aggregates: ";
  text += aggregates == 0 ? "no mesh" : std::to_string(aggregates) + (aggregates == 1 ? " mesh" : " meshes");
  return text + " (--aggregate " + aggregate_word(options) + "); codec " + format::name_of(options.codec) +
         "; promise " + format::name_of(options.promise);
}

}  // namespace meshlode::app
