// SPDX-License-Identifier: GPL-3.0-or-later
// When the border of a simplified group counts as the one it had (I6): docs/explanation/border-proof.md,
// says what and why. The judge has code of its own for the same definition; this is the builder's, so that nothing is
// written that the judge would refuse.
#pragma once

#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// By coordinates, as they are stored. An edge between two locked positions may be another group's too, so that it
/// counts as border of the source nowhere.
[[nodiscard]] bool keeps_border(const SimplifyInput& finer, const SimplifyResult& coarser);

/// Whether each position of a locked border that a triangle of `finer` has, one with three distinct corners, is a
/// corner in `coarser` too.
[[nodiscard]] bool keeps_locked_border(const SimplifyInput& finer, const SimplifyResult& coarser);

/// The input with every position of its border locked: whatever is collapsed then, the border stays edge by edge.
[[nodiscard]] SimplifyInput with_locked_border(SimplifyInput input);

}  // namespace meshlode::builder
