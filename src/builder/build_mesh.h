// SPDX-License-Identifier: GPL-3.0-or-later
// One mesh from its source triangles to pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <meshlode/format.h>
#include <meshlode/result.h>

#include "builder/encode/encode.h"
#include "builder/options.h"
#include "builder/plan/plan.h"
#include "builder/progress_meter.h"
#include "builder/stage_clock.h"
#include "builder/survey.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// The scene, and itself once more where it may be taken apart.
struct Source {
  const scene::Scene& scene;
  scene::Scene* owned = nullptr;

  void free_mesh(std::size_t index) const {
    if (owned == nullptr) return;
    for (scene::Primitive& primitive : owned->meshes[index].primitives) {
      const MaterialId material = primitive.material;
      primitive = {};
      primitive.material = material;
    }
  }
};

struct BuiltMesh {
  EncodedMesh encoded;
  std::vector<PlanDecision> decisions;
  StageClock clock;
  std::vector<LevelTime> levels;
  bool was_stored = false;
};

/// format::kPromises….
[[nodiscard]] std::uint32_t promises_of(format::Promise promise);

/// plan, prepare, dag, measure, hierarchy, encode. Errors are those of the stages, with the mesh's label.
[[nodiscard]] Result<BuiltMesh> build_mesh(const Source& from, std::size_t index, const Survey& found,
                                           const PipelineOptions& options, ProgressMeter& progress);

}  // namespace meshlode::builder
