// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of meshes that are aggregates become meshes of their own, before any mesh is built: after that a mesh is an
// aggregate or it is none.
#pragma once

#include <vector>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/options.h"
#include "scene/parts/split_parts.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// What scene::split_parts() is to take out of the scene: of the mesh "tree" the mesh "tree#leaves", or "tree#leaves2"
/// where another has that name. `decisions` and the options of meshes become those of the scene as it is then.
[[nodiscard]] std::vector<scene::MeshPart> plan_parts(const scene::Scene& scene,
                                                      std::vector<AggregateDecision>& decisions,
                                                      PipelineOptions& options);

}  // namespace meshlode::builder
