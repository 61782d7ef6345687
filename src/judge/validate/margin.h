// SPDX-License-Identifier: GPL-3.0-or-later
// The margin that errors and LOD spheres keep along the DAG so that the run-time rule's float rounding cannot undo I4
// (docs/reference/selection.md derives it). Restated here from the document: the judge shares no code with the builder.
#pragma once

#include "judge/validate/exact.h"

namespace meshlode::judge {

/// Whether a coarser group's error keeps the relative growth over a finer one, or both are 0.
[[nodiscard]] bool has_error_margin(float finer, float coarser);
/// Whether the coarser sphere contains the finer one with the margin. \pre finite, contains_ball(coarser, finer)
[[nodiscard]] bool has_sphere_margin(const ExactBall& coarser, const ExactBall& finer);
/// A bound that is the same bits as another needs no margin over it: the rule gives both the same answer.
[[nodiscard]] bool are_same_bits(const ExactBall& a, const ExactBall& b);

}  // namespace meshlode::judge
