// SPDX-License-Identifier: GPL-3.0-or-later
// The LOD DAG of one mesh, as `dag` hands it to `hierarchy` and `encode`. Plain flat arrays.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"
#include "scene/scene.h"

namespace meshlode::builder {

/// See format::StuckReason: the same values.
enum class StuckReason : std::uint32_t {
  kNotStuck = 0,
  kLocked = 1,
  kFlips = 2,
  kSeams = 3,
  kComponents = 4,
  kTooSmall = 5,
  kTopology = 6,
  kBorder = 7
};

struct DagCluster {
  std::uint32_t level = 0;
  GroupId own_group;                                 ///< the group it was made from; invalid at level 0
  GroupId coarser_group;                             ///< the group it is a member of: always valid, terminal for roots
  std::uint32_t first_vertex = 0, vertex_count = 0;  ///< into LodDag::vertex_…
  std::uint32_t first_triangle = 0, triangle_count = 0;  ///< into LodDag::triangle…
};

struct DagGroup {
  std::uint32_t level = 0;                             ///< largest level of a member
  std::uint32_t first_cluster = 0, cluster_count = 0;  ///< members, contiguous in LodDag::clusters
  /// Selection error, object units; +inf if terminal. The same as quadric_error until measure() is through.
  double error = 0.0;
  double quadric_error = 0.0;  ///< the quadric's own estimate, object units; +inf if terminal
  /// Of this group alone, without margin; +inf where not measured.
  double deviation = std::numeric_limits<double>::infinity();
  /// Shading normals (root mean square angle, degrees) and UVs (95% of the surface is within it, UV units) against the
  /// source's. Running maxima along the DAG; +inf if terminal, and where not measured: then for all groups of the mesh.
  double normal_deviation = std::numeric_limits<double>::infinity();
  double uv_deviation = std::numeric_limits<double>::infinity();
  bool is_terminal = false;
  bool is_aggregate = false;  ///< its error is of coverage (format::kGroupAggregate); never where terminal
  StuckReason stuck_reason = StuckReason::kNotStuck;  ///< not kNotStuck only where terminal
};

/// What attributes are stored as multiples of.
struct AttributeSteps {
  std::int32_t normal_scale = 0;  ///< of the octahedron's integer points; 0: no normals
  std::array<std::int32_t, scene::kMaxUvSets> uv_log2{};
};

/// Clusters are ordered by group and groups from coarse to fine (level descending), so that a prefix is a complete,
/// coarser mesh. Vertices and triangles of a cluster are contiguous and in its canonical order; triangles are sorted by
/// material, stable.
struct LodDag {
  std::vector<DagCluster> clusters;
  std::vector<DagGroup> groups;
  std::vector<Vec3i> vertex_position;                  ///< grid units; each vertex is of one cluster
  std::vector<float> vertex_attributes;                ///< AttributeLayout::stride() floats per vertex
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< local vertex indices of the cluster
  std::vector<std::uint32_t> triangle_material;
  std::uint32_t level_count = 0;
  std::optional<AttributeSteps> steps;  ///< once attributes are what the file stores (snap_attributes())

  [[nodiscard]] bool has_several_materials() const {
    const auto is_other = [&](std::uint32_t material) { return material != triangle_material.front(); };
    return std::any_of(triangle_material.begin(), triangle_material.end(), is_other);
  }
};

}  // namespace meshlode::builder
