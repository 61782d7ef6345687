// SPDX-License-Identifier: GPL-3.0-or-later
// One case at one parameter, put to the invariants or to every law.
#pragma once

#include <string>
#include <vector>

#include "hard_case.h"
#include "lab/experiment/experiment.h"
#include "laws/law.h"

namespace meshlode::test::hard {

struct Trial {
  Verdict verdict = Verdict::kFails;  ///< of the whole: the worst of the laws', or that it was refused
  std::string detail;                 ///< of that
  std::vector<LawResult> laws;        ///< as laws(); those that were not tried are kNotAsked
};

/// In this process. \pre the parameter is one that the case takes
[[nodiscard]] Trial try_case(const HardCase& hard_case, double parameter, bool all_laws, const lab::Care& care = {});

/// What a child prints and its parent reads: one line the whole, one line each law.
[[nodiscard]] std::string text_of(const Trial& trial);
/// False where the text is not that of a whole trial.
[[nodiscard]] bool parse_trial(const std::string& text, Trial& trial);

/// In a process of its own: `program trial NAME PARAMETER [--laws] [--care WORDS]`. `care` as `study --care` takes it.
[[nodiscard]] Trial try_apart(const std::string& program, const HardCase& hard_case, double parameter, bool all_laws,
                              const std::string& care = {});

}  // namespace meshlode::test::hard
