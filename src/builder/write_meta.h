// SPDX-License-Identifier: GPL-3.0-or-later
// The META text of an asset: where it came from, what was decided, what was left out. No paths, no time, no job count.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>

#include "builder/options.h"
#include "builder/plan/plan.h"

namespace meshlode::builder {

[[nodiscard]] std::string meta_json(const scene::Scene& scene, const PipelineOptions& options,
                                    const std::vector<PlanDecision>& decisions);

/// The same text with another name for the codec in its settings, to the byte. A text that is no JSON, or does not say
/// a codec, stays as it is.
[[nodiscard]] std::string meta_with_codec(std::string_view meta, format::Codec codec);

/// The same text as of a build that gave all meshes this tier.
[[nodiscard]] std::string meta_with_tier(std::string_view meta, format::ErrorTier tier);

}  // namespace meshlode::builder
