// SPDX-License-Identifier: GPL-3.0-or-later
// The one list of verbs: dispatch, help, completion and man pages read it.
#include "verb.h"

#include <utility>

namespace meshlode::cli {

namespace {

const Verb* const kVerbs[] = {
    &kBuildVerb,    &kPlanVerb,   &kInfoVerb,    &kRenderVerb, &kExtractVerb,    &kVerifyVerb,
    &kValidateVerb, &kDoctorVerb, &kCompareVerb, &kSweepVerb,  &kStreamVerb,     &kMeasureVerb,
    &kRepackVerb,   &kMergeVerb,  &kReportVerb,  &kCacheVerb,  &kCompletionVerb, &kManVerb,
};

}  // namespace

std::span<const Verb* const> all_verbs() {
  return kVerbs;
}

const Verb* find_verb(std::string_view name) {
  for (const Verb* verb : all_verbs()) {
    if (name == verb->name) return verb;
  }
  return name == kStudyVerb.name ? &kStudyVerb : nullptr;
}

std::vector<VerbHelp> all_verb_help() {
  std::vector<VerbHelp> all;
  for (const Verb* verb : all_verbs()) {
    VerbHelp help{verb->name, verb->summary, verb->description, verb->example, {}};
    Verb asked = *verb;
    asked.listed_options = &help.options;
    asked.run(asked, {});
    all.push_back(std::move(help));
  }
  return all;
}

}  // namespace meshlode::cli
