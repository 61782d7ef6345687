// SPDX-License-Identifier: GPL-3.0-or-later
// The META text of an asset: where it came from, what was decided, what was left out. No paths, no time, no job count.
#pragma once

#include <string>
#include <vector>

#include "build/build.h"
#include "build/plan/plan.h"

namespace meshlode::build {

[[nodiscard]] std::string meta_json(const scene::Scene& scene, const PipelineOptions& options,
                                    const std::vector<PlanDecision>& decisions);

}  // namespace meshlode::build
