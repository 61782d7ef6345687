// SPDX-License-Identifier: GPL-3.0-or-later
// What a build says of itself besides its bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/plan/plan.h"
#include "builder/progress.h"

namespace meshlode::builder {

struct PipelineReport {
  std::uint64_t memory_estimate = 0;  ///< bytes that the process takes at most, as estimated before the build
  std::vector<StageTime> stages;
  std::vector<LevelTime> levels;        ///< mesh by mesh
  std::vector<PlanDecision> decisions;  ///< of all meshes, in order
  std::uint64_t stored_meshes = 0;      ///< those that came from the mesh store
  std::uint64_t clusters = 0;           ///< of all meshes; 0: the asset draws nothing
};

}  // namespace meshlode::builder
