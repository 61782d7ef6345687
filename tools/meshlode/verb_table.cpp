// SPDX-License-Identifier: GPL-3.0-or-later
// The one list of verbs: dispatch and help both read it.
#include "verb.h"

namespace meshlode::cli {

namespace {

const Verb* const kVerbs[] = {
    &kBuildVerb, &kMergeVerb, &kPlanVerb, &kDoctorVerb, &kInfoVerb, &kCompareVerb, &kValidateVerb, &kVerifyVerb,
    &kRenderVerb, &kExtractVerb, &kRepackVerb,
};

}  // namespace

std::span<const Verb* const> all_verbs() {
  return kVerbs;
}

}  // namespace meshlode::cli
