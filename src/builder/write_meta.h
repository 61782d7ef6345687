// SPDX-License-Identifier: GPL-3.0-or-later
// The META text of an asset: where it came from, what was decided, what was left out. No paths, no time, no job count.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/format.h>

#include "builder/options.h"
#include "builder/plan/plan.h"
#include "builder/stored_images.h"
#include "scene/parts/split_parts.h"

namespace meshlode::builder {

/// `parts`: which meshes of the scene, its last, are parts of others. `replaced`: images that are not the source's.
[[nodiscard]] std::string meta_json(const scene::Scene& scene, const PipelineOptions& options,
                                    const std::vector<PlanDecision>& decisions,
                                    std::span<const scene::MeshPart> parts = {},
                                    std::span<const SourceImage> replaced = {});

/// The same text with another name for the codec in its settings, to the byte. A text that is no JSON, or does not say
/// a codec, stays as it is.
[[nodiscard]] std::string meta_with_codec(std::string_view meta, format::Codec codec);

/// The same text as of a build that gave all meshes this tier.
[[nodiscard]] std::string meta_with_tier(std::string_view meta, format::ErrorTier tier);

}  // namespace meshlode::builder
