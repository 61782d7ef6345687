// SPDX-License-Identifier: GPL-3.0-or-later
// What the options of a whole build mean to each of its stages.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshlode/result.h>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/dag/build_dag.h"
#include "builder/encode/encode.h"
#include "builder/options.h"
#include "builder/plan/plan.h"
#include "builder/prepare/prepare.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Errors: kUsage for a cluster size that the format has not, a group size out of range, an attribute that is both kept
/// and dropped, and for mesh options of another number of meshes.
[[nodiscard]] Status check_options(const PipelineOptions& options, std::size_t mesh_count);

/// Foliage and soups: so many pieces so small that they are seen together, not one by one.
[[nodiscard]] bool are_seen_together(std::uint64_t pieces, std::uint64_t triangles);

[[nodiscard]] AttributeRequest request_of(const MeshOptions& options, format::Promise promise);

[[nodiscard]] PrepareOptions prepare_options(const MeshOptions& options);

/// `texels`: texels_of_materials() of the scene, for a budget that is given in texels.
[[nodiscard]] EncodeOptions encode_options(const SceneOptions& whole, const MeshOptions& options,
                                           const scene::SourceMesh& source, const AttributeLayout& layout,
                                           std::span<const std::array<double, scene::kMaxUvSets>> texels);

/// `encode` says what a cluster will take in a page. \pre the mesh outlives what is returned
[[nodiscard]] DagOptions dag_options(const PipelineOptions& options, const PreparedMesh& mesh,
                                     const EncodeOptions& encode);

/// What is asked of a mesh of the scene; the scene and the options outlive it.
[[nodiscard]] AggregateQuestion aggregate_question(const scene::Scene& scene, std::size_t mesh,
                                                   const PipelineOptions& options);
/// One for each name in AggregateChoice::kNamed that nothing has; what it is about begins with kUnknownAggregate.
inline constexpr std::string_view kUnknownAggregate = "scene: aggregate '";
[[nodiscard]] std::vector<PlanDecision> unknown_names(const scene::Scene& scene, const PipelineOptions& options);

/// What was decided after the plan: that pieces which stay grow (`keeps_area`), what of borders is locked, that half of
/// the finest triangles or more have no area on the grid, and where texture coordinates are too large for their budget.
/// `label` names the mesh.
[[nodiscard]] std::vector<PlanDecision> late_decisions(const MeshOptions& own, const PreparedMesh& mesh,
                                                       bool keeps_area, const EncodeOptions& encode,
                                                       const EncodedMesh& encoded, const std::string& label);

}  // namespace meshlode::builder
