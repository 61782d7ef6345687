// SPDX-License-Identifier: GPL-3.0-or-later
// The loose pieces of a group: what hangs together by vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/group_places.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// Per vertex, one vertex of the piece that it belongs to, the same for all of them: pieces share no vertex.
[[nodiscard]] std::vector<std::uint32_t> pieces_of(const CollapseMesh& mesh, std::size_t vertex_count);

/// Of those that still have a triangle.
[[nodiscard]] std::size_t count_pieces(const CollapseMesh& mesh, std::size_t vertex_count);

/// Scales the pieces without a locked vertex about their centres, to at most twice their size, until the group covers
/// as much as the input did. Returns how far a vertex moved at most, in the frame.
double grow_pieces(const SimplifyInput& input, const CollapseMesh& mesh, GroupPlaces& places);

}  // namespace meshlode::builder
