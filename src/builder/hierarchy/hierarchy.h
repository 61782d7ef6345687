// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchy: spheres, culling bounds, normal cones and the BVH over a mesh's groups.
#pragma once

#include <cstdint>
#include <vector>

#include <meshlode/format.h>

#include "builder/hierarchy/enclosing_ball.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"

namespace meshlode::builder {

/// Per-mesh bounds. All lengths in object units relative to the mesh's origin, all ids per mesh.
struct Hierarchy {
  struct Sphere {
    float center[3];
    float radius;
  };
  struct Cone {
    std::int8_t axis[3];
    std::int8_t cutoff;
  };
  std::vector<Sphere> group_spheres;    ///< LOD spheres: nested with the margin of I4
  std::vector<float> group_errors;      ///< selection errors as stored: strictly growing along the DAG (or 0 = 0)
  std::vector<Sphere> cluster_spheres;  ///< tight culling spheres, in whole units of 2^sphere_log2 as the file has them
  std::int32_t sphere_log2 = format::kMinSphereLog2;
  std::vector<Cone> cluster_cones;
  std::vector<format::NodeRecord> nodes;  ///< ids per mesh; root first; children contiguous
};

[[nodiscard]] Hierarchy build_hierarchy(const LodDag& dag, const PreparedMesh& mesh,
                                        EnclosingBall enclose = enclosing_ball);

}  // namespace meshlode::builder
