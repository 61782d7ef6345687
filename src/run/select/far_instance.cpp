// SPDX-License-Identifier: MIT
#include "run/select/far_instance.h"

#include <algorithm>

namespace meshlode::run {

FarBound find_far_bound(const SelectTables& tables, const format::MeshRecord& mesh, std::span<const float> errors) {
  FarBound out;
  if (mesh.node_count == 0) return out;
  std::uint32_t roots = 0;
  float coarsest = 0.0F;
  for (std::uint32_t g = mesh.first_group; g < mesh.first_group + mesh.group_count; ++g) {
    if (errors[g] < format::kInfiniteError) {
      coarsest = std::max(coarsest, errors[g]);
    } else {
      out.only_root = roots++ == 0 ? g : format::kNone;
    }
  }
  out.bound = bound_of(tables.nodes[mesh.first_node]);
  out.bound.error = coarser_error(coarsest);
  return out;
}

}  // namespace meshlode::run
