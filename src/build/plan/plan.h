// SPDX-License-Identifier: GPL-3.0-or-later
// Plan: keep only what the scene calls for. Every decision has a reason, and says what it leaves out.
#pragma once

#include <string>
#include <vector>

#include <meshlode/build.h>

#include "build/prepared.h"
#include "scene/scene.h"

namespace meshlode::build {

struct PlanDecision {
  std::string what;    ///< "mesh 0: TEXCOORD_0"
  bool kept = false;
  std::string reason;  ///< "no material samples a texture through it"
  bool is_loss = false;  ///< left out although the scene's materials can show it
};

struct MeshPlan {
  AttributeLayout layout;
  std::vector<PlanDecision> decisions;
};

/// Decides the attributes of one mesh. `mesh_label` starts each decision's `what`.
[[nodiscard]] MeshPlan plan_mesh(const scene::SourceMesh& mesh, const std::vector<scene::SceneMaterial>& materials,
                                 AttributeChoice choice, const std::string& mesh_label);

}  // namespace meshlode::build
