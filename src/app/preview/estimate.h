// SPDX-License-Identifier: GPL-3.0-or-later
// What a mesh is thought to weigh in an asset before it is built: counts that are known, times bits that assets which
// were measured take (docs/reference/settings.md). Good to a quarter or so; `plan --measure` builds and counts.
#pragma once

#include <array>
#include <cstdint>

#include "builder/encode/encode.h"
#include "builder/prepare/prepare.h"
#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::app {

/// Bytes of decoded pages of all levels.
struct SizeEstimate {
  double positions = 0.0, normals = 0.0, colors = 0.0, topology = 0.0;
  std::array<double, scene::kMaxUvSets> uvs{};  ///< of the layout's stored sets
  [[nodiscard]] double total() const {
    return positions + normals + colors + topology + uvs[0] + uvs[1] + uvs[2] + uvs[3];
  }
};

/// What of a mesh the estimates of several layouts share.
struct SizeFacts {
  std::uint64_t triangles = 0;
  double position_bits = 0.0;                       ///< of one coordinate within a cluster
  std::array<double, scene::kMaxUvSets> uv_edge{};  ///< median extent of an edge, UV units, of TEXCOORD_n
};
[[nodiscard]] SizeFacts size_facts(const scene::SourceMesh& mesh, const builder::GridPlan& grid);

/// `uv_log2`: the step that each TEXCOORD_n is stored with.
[[nodiscard]] SizeEstimate estimate_size(const scene::SourceMesh& mesh, const builder::AttributeLayout& layout,
                                         const SizeFacts& facts, std::int32_t normal_scale,
                                         const std::array<std::int32_t, scene::kMaxUvSets>& uv_log2,
                                         std::uint32_t cluster_triangles);

}  // namespace meshlode::app
