// SPDX-License-Identifier: GPL-3.0-or-later
// Layers: surfaces that lie closely above one another and face the same way, such as a plate in a recess, a strap on
// cloth, a decal. Where one of two moves through the gap between them, what was hidden comes to lie in front of what
// was seen, although neither has moved farther than its error allows. So gaps are found in the source, before any mesh
// is built, and the simplifier is held to them (gap_label.h, simplify/gap_guard.h). Surfaces of one mesh and one
// material that has neither textures nor vertex colours look the same: between them no gap is looked for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace meshlode::builder {

struct MeshGaps {
  double reach = 0.0;               ///< object units: wider gaps are none
  std::vector<std::uint8_t> codes;  ///< per triangle, primitive by primitive: gap_label.h; empty: there are no gaps
};

/// What a reader is told of a mesh's gaps; no triangles: it has none.
struct GapSummary {
  std::uint64_t triangles = 0;           ///< that have a gap
  double narrowest = 0.0, widest = 0.0;  ///< object units, as codes round them
  std::vector<std::uint32_t> first;      ///< of these triangles the first, in the order of the codes
};
[[nodiscard]] GapSummary summarize(const MeshGaps& gaps);

/// By mesh. `wants`: of which meshes gaps are asked for; others are met all the same. The same for any order of meshes,
/// instances and triangles, and for any thread count.
[[nodiscard]] std::vector<MeshGaps> find_gaps(const scene::Scene& scene, std::span<const std::uint8_t> wants);

}  // namespace meshlode::builder
