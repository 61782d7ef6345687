// SPDX-License-Identifier: GPL-3.0-or-later
// The passes of the device's renderer that a scene will call for, from the plan of a build that has not been made.
#pragma once

#include "app/preview/scene_plan.h"
#include "draw/gpu/pass_plan.h"
#include "scene/scene.h"

namespace meshlode::cli {

/// As `render --gpu` decides it once the asset is there, with colours; counts of clusters are estimates.
[[nodiscard]] draw::PassPlan plan_scene_passes(const scene::Scene& scene, const app::ScenePlan& plan,
                                               std::uint32_t cluster_triangles);

}  // namespace meshlode::cli
