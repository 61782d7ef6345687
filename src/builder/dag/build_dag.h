// SPDX-License-Identifier: GPL-3.0-or-later
// DAG: cluster, then group, simplify and cluster again, until one cluster is left.
//
// The scheme is Nanite's (Karis 2021): borders between groups are locked while a group is simplified, and since groups
// are drawn anew at every level, what was locked on one level is free on the next.
#pragma once

#include <cstdint>
#include <functional>

#include <meshlode/result.h>

#include "builder/cluster/cluster.h"
#include "builder/cluster/group.h"
#include "builder/lod_dag.h"
#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

struct DagOptions {
  ClusterCaps caps;
  GroupOptions grouping;
  SimplifyGroup simplify_group = builder::simplify_group;
  SimplifyOptions simplify;           ///< target_triangles and may_relax_flips are set by the DAG
  double stuck_ratio = 0.85;          ///< a group that keeps more than this share of its triangles is retried
  std::uint32_t max_group_bytes = 0;  ///< decoded bytes that a group's clusters may take together; 0 = no limit
  /// Upper bound of the bytes of a cluster of so many vertices, triangles and materials. Needed with max_group_bytes.
  std::function<std::uint32_t(std::uint32_t vertices, std::uint32_t triangles, std::uint32_t materials)> cluster_bytes;
  /// Called after each level with the level's number and its triangles. Returning false cancels.
  std::function<bool(std::uint32_t level, std::uint64_t triangles)> on_level;
};

/// Errors of groups are the simplifier's own estimates: measure() finds the true ones, and changes nothing else. Error:
/// kBuildFailed when cancelled.
[[nodiscard]] Result<LodDag> build_dag(const PreparedMesh& mesh, const DagOptions& options);
/// The same. The mesh's surface on the grid is taken apart and freed along the way: its name, frame, layout, counts and
/// exact triangles are left.
[[nodiscard]] Result<LodDag> build_dag_and_free(PreparedMesh& mesh, const DagOptions& options);

}  // namespace meshlode::builder
