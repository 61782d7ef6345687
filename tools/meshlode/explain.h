// SPDX-License-Identifier: GPL-3.0-or-later
// What --explain prints: the lines of `plan`, of the scene that is built or of the asset that is drawn.
#pragma once

#include <string>
#include <vector>

#include "app/settings/settings.h"
#include "draw/raster/raster.h"
#include "run/read/asset.h"
#include "scene/scene.h"

namespace meshlode::cli {

/// A line for each setting and who said it; then those that meshes have for themselves.
[[nodiscard]] std::string describe_settings(const app::Settled& settled, const std::vector<app::SettledMesh>& meshes,
                                            const scene::Scene& scene);

/// Settings and plan of a build that is to come. Errors: plan_scene()'s.
[[nodiscard]] Result<std::string> explain_build(const std::vector<app::SettingLayer>& layers,
                                                const builder::PipelineOptions& options, const scene::Scene& scene);

/// What the asset says that its build kept and left out; of very many decisions the first.
[[nodiscard]] std::string describe_recorded_plan(const run::Asset& asset);

/// What the CPU's rasterizer does for this asset, and what it spares itself.
[[nodiscard]] std::string describe_cpu_passes(const run::Asset& asset, const draw::AlphaMasks& masks, draw::View view);

}  // namespace meshlode::cli
