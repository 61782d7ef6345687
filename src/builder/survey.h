// SPDX-License-Identifier: GPL-3.0-or-later
// What is found out about the whole scene before any mesh is built.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <meshlode/result.h>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/aggregate/coarse_materials.h"
#include "builder/layers/find_gaps.h"
#include "builder/options.h"
#include "builder/plan/plan.h"
#include "builder/plan/texel_sizes.h"
#include "scene/scene.h"

namespace meshlode::builder {

struct Survey {
  std::vector<std::array<double, scene::kMaxUvSets>> texels;  ///< texels_of_materials()
  std::vector<TexelExtents> extents;          ///< texel_extents_of_materials(), where more than positions is promised
  std::vector<AggregateDecision> aggregates;  ///< by mesh
  std::vector<MeshGaps> gaps;                 ///< by mesh
  CoarseMaterials coarse;                     ///< where some mesh has an aggregate
  [[nodiscard]] bool has_aggregates() const {
    return std::any_of(aggregates.begin(), aggregates.end(), [](const AggregateDecision& d) { return d.is_aggregate; });
  }
};

/// By mesh.
[[nodiscard]] std::vector<AggregateDecision> decide_aggregates(const scene::Scene& scene,
                                                               const PipelineOptions& options);

/// By mesh: which gaps are kept. Of aggregates none, of loose pieces that are seen together, and of what
/// is one cluster; nor where the options say so.
[[nodiscard]] std::vector<MeshGaps> find_layers(const scene::Scene& scene,
                                                const std::vector<AggregateDecision>& aggregates,
                                                const PipelineOptions& options);

/// What is said of a mesh that has gaps. `label` names it.
[[nodiscard]] PlanDecision describe_gaps(const MeshGaps& gaps, std::uint64_t triangles, const std::string& label);

/// `aggregates`: of decide_aggregates(). Error: a derived material that cannot be.
[[nodiscard]] Result<Survey> survey(const scene::Scene& scene, const PipelineOptions& options,
                                    std::vector<AggregateDecision> aggregates);

}  // namespace meshlode::builder
