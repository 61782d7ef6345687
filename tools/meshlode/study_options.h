// SPDX-License-Identifier: GPL-3.0-or-later
// What `study` has beyond `build`: experiments (lab/experiment/experiment.h).
#pragma once

#include <optional>
#include <string>

#include <meshlode/result.h>

#include "builder/hooks.h"
#include "options.h"

namespace meshlode::cli {

struct StudyWords {
  std::string care = "all", simplifier = "own";
};

void add_study_options(OptionParser& parser, StudyWords& words);

/// None where nothing is another than usual. Error: kUsage.
[[nodiscard]] Result<std::optional<builder::BuildHooks>> hooks_of(const StudyWords& words);

}  // namespace meshlode::cli
