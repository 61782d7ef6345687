// SPDX-License-Identifier: GPL-3.0-or-later
// OpenMesh's half-edge mesh as a judge of what is a surface: an edge of two triangles at most, in opposite directions,
// and one fan around each vertex.
#pragma once

#include <cstdint>
#include <span>

namespace meshlode::test {

struct HalfedgeVerdict {
  std::uint64_t refused = 0;           ///< triangles that it does not take: complex edges or vertices
  std::uint64_t complex_vertices = 0;  ///< of several fans
};

/// Triangles of three different vertices each: OpenMesh aborts on others.
HalfedgeVerdict judge_by_halfedges(std::span<const std::uint32_t> indices, std::size_t vertex_count);

}  // namespace meshlode::test
