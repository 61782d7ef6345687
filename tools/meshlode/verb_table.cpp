// SPDX-License-Identifier: GPL-3.0-or-later
// The one list of verbs: dispatch and help both read it. A verb whose room is not built is left out (CMakeLists.txt).
#include "verb.h"

#include <iterator>

namespace meshlode::cli {

namespace {

const Verb* const kVerbs[] = {
#ifdef MESHLODE_VERB_BUILD
    &kBuildVerb,
#endif
#ifdef MESHLODE_VERB_INFO
    &kInfoVerb,
#endif
#ifdef MESHLODE_VERB_VALIDATE
    &kValidateVerb,
#endif
#ifdef MESHLODE_VERB_VERIFY
    &kVerifyVerb,
#endif
#ifdef MESHLODE_VERB_RENDER
    &kRenderVerb,
#endif
#ifdef MESHLODE_VERB_EXTRACT
    &kExtractVerb,
#endif
    nullptr,  // so that the list is never empty
};

}  // namespace

std::span<const Verb* const> all_verbs() {
  return std::span(kVerbs).first(std::size(kVerbs) - 1);
}

}  // namespace meshlode::cli
