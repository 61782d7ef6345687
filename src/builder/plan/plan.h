// SPDX-License-Identifier: GPL-3.0-or-later
// Plan: keep only what the scene calls for. Every decision has a reason, and says what it leaves out.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <meshlode/build.h>

#include "base/enum_names.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder {

inline constexpr std::array<EnumName<AttributeChoice>, 3> kAttributeChoiceNames{
    {{AttributeChoice::kAuto, "auto"}, {AttributeChoice::kNone, "none"}, {AttributeChoice::kAll, "all"}}};
constexpr const char* name_of(AttributeChoice choice) {
  return name_in(kAttributeChoiceNames, choice);
}

struct PlanDecision {
  std::string what;  ///< "mesh 0: TEXCOORD_0"
  bool kept = false;
  std::string reason;       ///< "no material samples a texture through it"
  bool is_loss = false;     ///< left out although it can be seen
  std::string attribute{};  ///< "TEXCOORD_0"; empty where the decision is about something else
  bool is_forced = false;   ///< by a name in AttributeRequest::keep or drop, against what would have been decided
  std::uint32_t mesh = 0;   ///< which mesh of the scene, kNone for none; set where decisions of several are in one list
};

/// What the caller asks for: by rule, then by name.
struct AttributeRequest {
  AttributeChoice choice = AttributeChoice::kAuto;
  std::uint32_t keep = 0, drop = 0;  ///< bits of plan/attributes.h; none is in both
  bool promises_normals = false;     ///< those that are nearly their triangles' own are not left out
};

struct MeshPlan {
  AttributeLayout layout;
  std::vector<PlanDecision> decisions;
};

/// "mesh 3 'rock'", what decisions and errors call a mesh.
[[nodiscard]] std::string mesh_label(const scene::SourceMesh& mesh, std::size_t index);

/// Decides the attributes of one mesh. `mesh_label` starts each decision's `what`.
[[nodiscard]] MeshPlan plan_mesh(const scene::SourceMesh& mesh, const std::vector<scene::SceneMaterial>& materials,
                                 const AttributeRequest& request, const std::string& mesh_label);

/// Names that made a difference: bits of what was kept, or dropped, by name alone.
[[nodiscard]] std::uint32_t forced_attributes(std::span<const PlanDecision> decisions, bool kept);

}  // namespace meshlode::builder
