// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene has beside triangles and attributes, and what becomes of each: acted on, carried through, or left out.
#pragma once

#include <vector>

#include "builder/plan/plan.h"
#include "builder/textures/texture_choice.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// In a fixed order; only what the scene has. What import left out comes last, in its words.
[[nodiscard]] std::vector<PlanDecision> list_features(const scene::Scene& scene, const TextureChoice& textures);

/// Those of them that a rule decides, of materials and instances: what the asset records. What is carried through
/// stands in the asset anyway.
[[nodiscard]] std::vector<PlanDecision> list_ruled_features(const scene::Scene& scene);

}  // namespace meshlode::builder
