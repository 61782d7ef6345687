// SPDX-License-Identifier: GPL-3.0-or-later
// The whole build, scene in and file bytes out. src/builder/builder.cpp is the page to read first.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/result.h>

#include "builder/options.h"
#include "builder/plan/plan.h"
#include "builder/progress.h"
#include "builder/report.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Thread count is the caller's: run inside a tbb::task_arena or under tbb::global_control.
[[nodiscard]] Result<std::vector<std::uint8_t>> build_lode(const scene::Scene& scene, const PipelineOptions& options,
                                                           const ProgressCallback& progress, PipelineReport& report);
/// The same bytes. Each mesh's source is freed as soon as it is prepared, so that the peak is lower; what is left of
/// the scene is of no use.
[[nodiscard]] Result<std::vector<std::uint8_t>> build_lode(scene::Scene&& scene, const PipelineOptions& options,
                                                           const ProgressCallback& progress, PipelineReport& report);

}  // namespace meshlode::builder
