// SPDX-License-Identifier: GPL-3.0-or-later
// Built meshes as what is written and what is reported.
#pragma once

#include <vector>

#include "builder/build_mesh.h"
#include "builder/options.h"
#include "builder/report.h"
#include "builder/write/write.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Fills the report's decisions, levels, clusters and stage times. Of what is returned materials, document and META are
/// the caller's to set. The scene outlives it.
[[nodiscard]] WriteInput gather(const scene::Scene& scene, std::vector<BuiltMesh> meshes,
                                const PipelineOptions& options, PipelineReport& report);

}  // namespace meshlode::builder
