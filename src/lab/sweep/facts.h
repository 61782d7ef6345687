// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep says of its scene, and what its figures depend on.
#pragma once

#include <string>

#include "lab/sweep/sweep.h"

namespace meshlode::lab {

[[nodiscard]] SceneSummary summary_of(const scene::Scene& scene);
/// Of the baseline's asset.
[[nodiscard]] SceneFacts facts_of(const run::Asset& asset);
/// All that figures depend on beside a point's settings.
[[nodiscard]] std::string fingerprint_of(const SweepOptions& options, const SweepResult& result);

}  // namespace meshlode::lab
