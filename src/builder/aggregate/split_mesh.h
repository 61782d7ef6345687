// SPDX-License-Identifier: GPL-3.0-or-later
// A mesh of which a part is an aggregate, a tree of trunk and leaves, as two: they share no position, so that each has
// levels of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/prepared.h"

namespace meshlode::builder {

/// Both in the mesh's frame and on its grid, in its order.
struct SplitMesh {
  PreparedMesh loose;  ///< the pieces that are thinned out
  PreparedMesh solid;  ///< the others
};

/// Loose are pieces all of whose triangles are of a material that allows so many: AggregateDecision::most_triangles. On
/// the grid a piece may have come to touch another, and is one with it then. Of the mesh its name, frame, layout and
/// counts are left.
[[nodiscard]] SplitMesh split_and_free(PreparedMesh& mesh, std::span<const std::uint32_t> most_triangles);

}  // namespace meshlode::builder
