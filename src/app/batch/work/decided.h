// SPDX-License-Identifier: GPL-3.0-or-later
// What a build decided by what its scene has, in one line.
#pragma once

#include <span>
#include <string>

#include "builder/options.h"
#include "builder/plan/plan.h"

namespace meshlode::app {

/// "attributes NORMAL, TEXCOORD_0 of some meshes; aggregates: 1 mesh (--aggregate masked); codec strips; promise
/// position". `plan` says why.
[[nodiscard]] std::string describe_decided(const builder::PipelineOptions& options,
                                           std::span<const builder::PlanDecision> decisions);

}  // namespace meshlode::app
