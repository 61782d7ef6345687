// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a group's triangles, each use of one beside the others.
#pragma once

#include <cstdint>
#include <vector>

#include "builder/simplify/collapse_mesh.h"

namespace meshlode::builder {

struct EdgeUse {
  std::uint32_t a, b;    ///< vertices, a < b
  std::uint32_t corner;  ///< whose edge to the next corner this is
};

/// Of the living triangles, ascending by a, b and corner.
[[nodiscard]] std::vector<EdgeUse> sorted_edge_uses(const CollapseMesh& mesh);

}  // namespace meshlode::builder
