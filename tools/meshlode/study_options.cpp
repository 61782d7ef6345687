// SPDX-License-Identifier: GPL-3.0-or-later
#include "study_options.h"
#include "base/try.h"

#include "lab/experiment/experiment.h"

namespace meshlode::cli {

void add_study_options(OptionParser& parser, StudyWords& words) {
  parser.group("Experiments (recorded in the asset)");
  parser.add_value("--care NAME=off,...", words.care, "leave out double-quadrics, fallback, spheres or needles");
  parser.add_value("--simplifier", words.simplifier, "what simplifies the groups: OpenMesh's decimater, to compare",
                   all_names(lab::kSimplifierNames));
}

Result<std::optional<builder::BuildHooks>> hooks_of(const StudyWords& words) {
  TRY_LET(care, lab::parse_care(words.care));
  lab::Experiment experiment;
  experiment.care = *care;
  experiment.simplifier = value_in(lab::kSimplifierNames, words.simplifier).value_or(experiment.simplifier);
  std::optional<builder::BuildHooks> hooks;
  if (!experiment.is_none()) hooks = lab::hooks_of(experiment);
  return hooks;
}

}  // namespace meshlode::cli
