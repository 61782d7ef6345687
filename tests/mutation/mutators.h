// SPDX-License-Identifier: GPL-3.0-or-later
// Kinds of mutants: each changes one field of a sound asset. What a kind means for the judge is part of it: a mutant
// that changes the meaning must be found; where some mutants are as good as the original, the kind says which and why.
#pragma once

#include <functional>
#include <vector>

#include "base/random.h"
#include "judge/validate/edit.h"

namespace meshlode::test {

struct MutantKind {
  const char* name;
  /// Null: every mutant must be found. Else why a mutant of this kind may be as valid as the original.
  const char* equivalent;
  /// Changes one thing; false where this draw finds nothing to change.
  std::function<bool(AssetEdit&, SplitMix64&)> mutate;
};

[[nodiscard]] const std::vector<MutantKind>& mutant_kinds();

}  // namespace meshlode::test
