// SPDX-License-Identifier: MIT
// Bounds on attributes beside the metric: a group passes only if its stored normal and UV deviations are within them.
// Those never fall along the DAG and are compared as they are, so what passes stays closed towards the finer side (I5).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshlode/format.h>

#include "base/ids.h"

namespace meshlode::run {

struct SelectTables;

/// A bound of kInfiniteError or more is none. A bound on what a mesh does not store (normals left out, no UVs) is none
/// for it; where the deviation was not measured, no group of the mesh passes.
struct AttributeBounds {
  double normal_degrees = double{format::kInfiniteError};
  double uv = double{format::kInfiniteError};
  [[nodiscard]] bool has_any() const {
    return normal_degrees < double{format::kInfiniteError} || uv < double{format::kInfiniteError};
  }
};

/// The bounds that apply to one mesh.
[[nodiscard]] AttributeBounds bounds_for(const AttributeBounds& bounds, const format::MeshRecord& mesh);

/// \pre `bounds` are those for the group's mesh
[[nodiscard]] inline bool is_within(const AttributeBounds& bounds, const format::GroupRecord& group) {
  return double{group.normal_deviation} <= bounds.normal_degrees && double{group.uv_deviation} <= bounds.uv;
}

/// Per BVH node of a mesh whether every group below is within the bounds: what a node must have beside its metric to
/// close its subtree (I8). Derived when asked for, not stored.
[[nodiscard]] std::vector<std::uint8_t> find_nodes_within(const SelectTables& tables, const format::MeshRecord& mesh,
                                                          const AttributeBounds& bounds);

/// The largest deviations of the groups that the clusters were made from; 0 for clusters of level 0, kInfiniteError
/// where one was not measured.
struct CutAttributeDeviation {
  double normal_degrees = 0.0, uv = 0.0;
};
[[nodiscard]] CutAttributeDeviation attribute_deviation_of(const SelectTables& tables,
                                                           std::span<const ClusterId> clusters);

}  // namespace meshlode::run
