// SPDX-License-Identifier: GPL-3.0-or-later
// A DAG as measuring sees it: the same for the same geometry, in whatever order vertices and triangles lie within their
// clusters. A DAG that a build has just made and one that was read from an asset get the same errors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshlode/result.h>

#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

struct CanonicalForm {
  /// LodDag::triangles with each cluster's in an order of their own, each from its first corner on: by place on the
  /// grid, then by attributes.
  std::vector<std::array<std::uint8_t, 3>> triangles;
  /// LodDag::triangle_material in their order; none where all are equal.
  std::vector<std::uint32_t> triangle_material;
  std::vector<std::uint32_t> position_of_vertex;  ///< the same for all vertices of one place on the grid
  std::uint32_t position_count = 0;
  /// Per source triangle: the triangle of level 0 that it became, and that one's vertices, corner by corner.
  struct Level0Triangle {
    std::uint32_t cluster = 0, triangle = 0;  ///< of the LodDag
  };
  std::vector<Level0Triangle> level0_of_source;
  std::vector<WedgeTriangle> vertices_of_source;  ///< of the LodDag
};

/// Level 0 is matched to the source by places on the grid; of triangles in the same places the first of the one is the
/// first of the other. Errors: kCheckFailed where level 0 is another surface than the source; kUnsupported for 2^32
/// vertices and more.
[[nodiscard]] Result<CanonicalForm> canonical_form(const PreparedMesh& mesh, const LodDag& dag);

}  // namespace meshlode::builder
