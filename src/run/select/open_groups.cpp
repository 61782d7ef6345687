// SPDX-License-Identifier: MIT
#include "run/select/open_groups.h"

#include <algorithm>

namespace meshlode::run {

bool is_drawable(const SelectTables& tables, const format::InstanceRecord& instance) {
  return (instance.flags & format::kInstanceSingular) == 0 && instance.mesh < tables.meshes.size() &&
         tables.meshes[instance.mesh].group_count > 0;
}

void find_open_groups(const SelectTables& tables, const InstanceView& view, OpenGroups& out) {
  const format::MeshRecord& mesh = view.mesh;
  out.groups.clear();
  out.stack.clear();
  if (mesh.node_count > 0) out.stack.push_back({mesh.first_node, view.frustum.crossed});
  while (!out.stack.empty()) {
    const auto [id, parent_crossed] = out.stack.back();
    out.stack.pop_back();
    const format::NodeRecord& node = tables.nodes[id];
    ++out.work.nodes;
    const std::uint32_t crossed =
        parent_crossed == 0 ? 0 : crossed_planes(view.frustum, parent_crossed, node.center, node.radius);
    if (crossed == kOutside) continue;
    const bool is_within = view.nodes_within == nullptr || view.nodes_within[id - mesh.first_node] != 0;
    // Then every group below passes, and none of their members is drawn.
    if (is_within &&
        metric_passes(view.metric, node.center[0], node.center[1], node.center[2], node.radius, node.error)) {
      continue;
    }
    if (node.child_count == 0) {
      out.groups.push_back({node.first, crossed});
      continue;
    }
    // Children lie behind their node, which also keeps a damaged table from looping.
    for (std::uint32_t c = 0; c < node.child_count && node.first > id; ++c) {
      out.stack.push_back({node.first + c, crossed});
    }
  }
  std::sort(out.groups.begin(), out.groups.end(),
            [](const OpenGroup& a, const OpenGroup& b) { return a.group < b.group; });
}

}  // namespace meshlode::run
