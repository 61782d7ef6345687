// SPDX-License-Identifier: MIT
#include "run/select/attribute_bounds.h"

#include <algorithm>

#include "run/select/select.h"

namespace meshlode::run {

AttributeBounds bounds_for(const AttributeBounds& bounds, const format::MeshRecord& mesh) {
  AttributeBounds own;
  if (mesh.normal_mode != format::NormalMode::kNone) own.normal_degrees = bounds.normal_degrees;
  if (mesh.uv_set_count > 0) own.uv = bounds.uv;
  return own;
}

std::vector<std::uint8_t> find_nodes_within(const SelectTables& tables, const format::MeshRecord& mesh,
                                            const AttributeBounds& bounds) {
  std::vector<std::uint8_t> within(mesh.node_count, 1);
  for (std::uint32_t i = mesh.node_count; i-- > 0;) {  // children lie behind their node
    const std::uint32_t id = mesh.first_node + i;
    const format::NodeRecord& node = tables.nodes[id];
    if (node.child_count == 0) {
      within[i] = is_within(bounds, tables.groups[node.first]) ? 1 : 0;
      continue;
    }
    for (std::uint32_t c = 0; c < node.child_count && node.first > id; ++c) {
      if (within[node.first + c - mesh.first_node] == 0) within[i] = 0;
    }
  }
  return within;
}

CutAttributeDeviation attribute_deviation_of(const SelectTables& tables, std::span<const ClusterId> clusters) {
  CutAttributeDeviation out;
  for (const ClusterId id : clusters) {
    const std::uint32_t own = tables.clusters[id.value].own_group;
    if (own == format::kNone) continue;
    out.normal_degrees = std::max(out.normal_degrees, double{tables.groups[own].normal_deviation});
    out.uv = std::max(out.uv, double{tables.groups[own].uv_deviation});
  }
  return out;
}

}  // namespace meshlode::run
