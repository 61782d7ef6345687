// SPDX-License-Identifier: GPL-3.0-or-later
// How many vertices a mesh has once equal ones are one: by position, or by position and the attributes that are kept.
#pragma once

#include <cstdint>

#include "builder/prepared.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// Different vertices of all primitives together.
struct WedgeCounts {
  std::uint64_t positions = 0;
  std::uint64_t wedges = 0;  ///< told apart by position and by what the layout keeps: no fewer
};

/// Of vertices whose position's hash falls into a share that leaves a hundred thousand, exactly; the others are taken
/// to be like them (Flajolet 1990).
[[nodiscard]] WedgeCounts count_wedges(const scene::SourceMesh& mesh, const AttributeLayout& layout);

}  // namespace meshlode::builder
