// SPDX-License-Identifier: GPL-3.0-or-later
// One group simplified and clustered, before it is known whether it is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "builder/cluster/cluster.h"
#include "builder/cluster/group.h"
#include "builder/dag/build_dag.h"
#include "builder/dag/level_pool.h"
#include "builder/dag/level_use.h"
#include "builder/prepared.h"
#include "builder/simplify/simplify.h"

namespace meshlode::builder {

/// How hard a round tries. Later ones give up something to get anywhere at all.
struct Effort {
  std::uint32_t target_clusters;  ///< of groups: another size gives other neighbours
  bool may_relax_flips;
};
inline constexpr Effort kEfforts[] = {{20, false}, {28, false}, {13, false}, {32, true}, {24, true}};

/// The efforts' sizes are those of the usual one: where another is asked for, retries are as much larger or smaller.
[[nodiscard]] std::uint32_t groups_aim_at(const Effort& effort, const GroupOptions& asked);

/// What a group is asked for.
struct GroupTask {
  double share = 0.5;     ///< of its triangles, to be kept
  bool is_whole = false;  ///< it is all that is left of the mesh
  Effort effort{};
};

/// What the first round's groups keep: from 0.69 down to 0.35, a half on average, evenly in logarithms from the first
/// group to the last. Groups are in spatial order. If all kept a half, all errors of a level would be about equal, and
/// a cut would double its triangles at once as the threshold passes them; so the regions of a mesh are out of step, and
/// the mean deviation of a cut is close to what its threshold allows, whatever that is.
[[nodiscard]] double first_share(std::size_t group, std::size_t groups);

struct Attempt {
  SimplifyResult result;
  Clustering clustering;
  std::vector<Vec3i> new_places;  ///< where topology is kept
  std::uint32_t source_triangles = 0;
  bool is_accepted = false;
};

/// Nothing of the pool is changed.
[[nodiscard]] Attempt attempt_group(const BuildPool& pool, const PreparedMesh& mesh,
                                    const std::vector<ClusterId>& clusters, const Shared& shared, const GroupTask& task,
                                    const DagOptions& options);

}  // namespace meshlode::builder
