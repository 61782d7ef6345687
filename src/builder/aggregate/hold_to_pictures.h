// SPDX-License-Identifier: GPL-3.0-or-later
// Groups are measured one by one, and what two of them cover together neither knows of: whole cuts are looked at, and
// where one has too much what came last waits for larger pixels.
#pragma once

#include <span>
#include <vector>

#include "builder/aggregate/card.h"
#include "builder/aggregate/coverage_error.h"
#include "builder/aggregate/fit_factor.h"
#include "builder/aggregate/leaves.h"
#include "builder/aggregate/noise_budget.h"
#include "builder/aggregate/pictures.h"

namespace meshlode::builder {

/// An aggregate with all ways of thinning it out, by level and group.
struct ThinnedWays {
  const SourceSurface& source;
  const MeshFrame& frame;
  const Leaves& leaves;
  const Cards& cards;
  std::span<const std::vector<GroupProposals>> proposals;
  std::span<const std::vector<std::vector<Fitted>>> fitted;
};

/// Moves uses to larger pixels, or takes them away, until every whole cut is as it should be, as pictures tell where
/// pixels double. `finest`: as measure_proposals() had it; small meshes have their own.
void hold_to_pictures(const ThinnedWays& ways, double finest, std::vector<std::vector<NoiseUse>>& uses);

}  // namespace meshlode::builder
