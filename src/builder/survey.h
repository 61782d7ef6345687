// SPDX-License-Identifier: GPL-3.0-or-later
// What is found out about the whole scene before any mesh is built.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include <meshlode/result.h>

#include "builder/aggregate/aggregate_choice.h"
#include "builder/aggregate/coarse_materials.h"
#include "builder/options.h"
#include "builder/plan/texel_sizes.h"
#include "scene/scene.h"

namespace meshlode::builder {

struct Survey {
  std::vector<std::array<double, scene::kMaxUvSets>> texels;  ///< texels_of_materials()
  std::vector<TexelExtents> extents;          ///< texel_extents_of_materials(), where more than positions is promised
  std::vector<AggregateDecision> aggregates;  ///< by mesh
  CoarseMaterials coarse;                     ///< where some mesh has an aggregate
  [[nodiscard]] bool has_aggregates() const {
    return std::any_of(aggregates.begin(), aggregates.end(), [](const AggregateDecision& d) { return d.is_aggregate; });
  }
};

/// By mesh.
[[nodiscard]] std::vector<AggregateDecision> decide_aggregates(const scene::Scene& scene,
                                                               const PipelineOptions& options);

/// `aggregates`: of decide_aggregates(). Error: a derived material that cannot be.
[[nodiscard]] Result<Survey> survey(const scene::Scene& scene, const PipelineOptions& options,
                                    std::vector<AggregateDecision> aggregates);

}  // namespace meshlode::builder
