// SPDX-License-Identifier: GPL-3.0-or-later
// The edges of a group that are held in place: borders of the source, of materials and of texture charts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "builder/simplify/collapse_mesh.h"
#include "builder/simplify/edge_uses.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// One use of an edge by a triangle, in whose plane the edge is held.
struct HeldEdge {
  std::uint32_t a, b;  ///< vertices, a < b
  std::uint32_t triangle;
  double weight;  ///< of a wall that stands on it; 1 on a border
  bool is_border;
};

struct HeldEdges {
  std::vector<HeldEdge> edges;          ///< ascending by a, b, and corners of the triangle
  std::vector<std::uint8_t> is_border;  ///< per vertex: on an edge that has not just two triangles
  bool has_free_border = false;         ///< an edge of the oriented border has an end that may move
  bool is_manifold = true;              ///< at most two triangles stand on an edge, and they run along it both ways
};

/// Nothing holds an edge between two ends that stay. `uses` are sorted_edge_uses() of the mesh.
[[nodiscard]] HeldEdges find_held_edges(const SimplifyInput& input, const SimplifyOptions& options,
                                        const CollapseMesh& mesh, std::span<const EdgeUse> uses);

}  // namespace meshlode::builder
