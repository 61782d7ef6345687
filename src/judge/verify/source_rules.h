// SPDX-License-Identifier: GPL-3.0-or-later
// The asset against its source (V1…). Internal to the judge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "judge/validate/rules.h"
#include "judge/verify/triangle_key.h"
#include "run/decode/decode.h"
#include "scene/scene.h"

namespace meshlode::judge {

struct SourceCounts {
  std::uint64_t source_triangles = 0;  ///< looked for
  std::uint64_t level0_triangles = 0;
  std::uint64_t corners = 0;      ///< whose attributes were compared
  std::vector<GridPoint> border;  ///< of the source's open border, where it is asked for
};

/// V101 … V105 for one mesh. \pre `clusters` is decode_all of the asset
[[nodiscard]] SourceCounts check_source_triangles(const run::Asset& asset, MeshId mesh, const scene::SourceMesh& source,
                                                  std::span<const run::DecodedCluster> clusters, bool wants_border,
                                                  RuleLog& log);

/// V106 … V113. \pre `clusters` is decode_all of the asset
void check_scene(const run::Asset& asset, const scene::Scene& source, std::span<const run::DecodedCluster> clusters,
                 RuleLog& log);

}  // namespace meshlode::judge
