// SPDX-License-Identifier: MIT
// The groups of one instance that do not pass, found through the BVH: what both selections start from.
#pragma once

#include <cstdint>
#include <vector>

#include "run/select/frustum.h"
#include "run/select/select.h"

namespace meshlode::run {

struct OpenGroup {
  std::uint32_t group;
  std::uint32_t crossed;  ///< planes of the view volume that its sphere crosses
};

/// Memory that one search leaves to the next.
struct OpenGroups {
  std::vector<OpenGroup> groups;  ///< of the last search, ascending
  std::vector<OpenGroup> stack;   ///< nodes
  TraversalCount work;
};

/// One instance and what it is seen by.
struct InstanceView {
  const format::MeshRecord& mesh;
  MetricView metric;
  MeshFrustum frustum;
  const std::uint8_t* nodes_within = nullptr;  ///< of find_nodes_within(); null without bounds
};

[[nodiscard]] inline bool passes(const MetricView& view, const format::GroupRecord& group) {
  return metric_passes(view, group.center[0], group.center[1], group.center[2], group.radius, group.error);
}

/// \param crossed  of the cluster's group
[[nodiscard]] inline bool is_outside(const InstanceView& view, std::uint32_t crossed,
                                     const format::ClusterRecord& cluster) {
  if (crossed == 0) return false;
  const format::CullSphere sphere = format::cull_sphere(view.mesh, cluster);
  return crossed_planes(view.frustum, crossed, sphere.center, sphere.radius) == kOutside;
}

/// Singular instances and those of an empty mesh are not drawn.
[[nodiscard]] bool is_drawable(const SelectTables& tables, const format::InstanceRecord& instance);

/// Those whose sphere is not outside the view volume.
void find_open_groups(const SelectTables& tables, const InstanceView& view, OpenGroups& out);

}  // namespace meshlode::run
