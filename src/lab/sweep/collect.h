// SPDX-License-Identifier: GPL-3.0-or-later
// From measurements to figures of points, and from these to answers.
#pragma once

#include <cstdint>
#include <vector>

#include "lab/sweep/answers.h"
#include "lab/sweep/state.h"
#include "lab/sweep/sweep.h"

namespace meshlode::lab {

/// Sets what each point has: is_done, error, figures, asset, drawn. A planned point that nothing was measured of is
/// left out. The result points into the state.
void collect_results(const State& state, std::uint32_t rounds, SweepResult& result);

/// Sets dominated_by, frontiers and recommendations. No wishes: some usual ones, as far as some point keeps them.
void answer_all(const std::vector<Wish>& wishes, SweepResult& result);

/// Of the points that are done, in the order of result.points; `places` gets the place of each there.
[[nodiscard]] std::vector<Candidate> candidates_of(const SweepResult& result, std::vector<std::size_t>& places);

}  // namespace meshlode::lab
