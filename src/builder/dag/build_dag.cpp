// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/build_dag.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/parallel.h"
#include "base/release.h"
#include "base/try.h"
#include "builder/dag/group_attempt.h"
#include "builder/dag/level_pool.h"
#include "builder/dag/level_use.h"
#include "builder/simplify/kept_topology.h"

namespace meshlode::builder {

namespace {

/// Ends the DAG: what is left is never replaced.
void add_terminal_groups(BuildPool& pool, const std::vector<ClusterId>& live, const GroupOptions& grouping,
                         const DagOptions& options, const std::vector<StuckReason>& reasons) {
  const std::vector<std::vector<std::uint32_t>> groups =
      group_clusters(use_of_level(pool, live, options).grouping, grouping);
  for (const std::vector<std::uint32_t>& members : groups) {
    BuildGroup group;
    group.is_terminal = true;
    for (const std::uint32_t i : members) {
      group.clusters.push_back(live[i]);
      group.level = std::max(group.level, pool.cluster(live[i]).level);
      // Where something else stands in the way too, that is said.
      const bool is_open = group.stuck_reason == StuckReason::kNotStuck || group.stuck_reason == StuckReason::kBorder;
      if (is_open && reasons[i] != StuckReason::kNotStuck) group.stuck_reason = reasons[i];
    }
    pool.groups.push_back(std::move(group));
  }
}

/// The clusters that nothing coarser has replaced so far, and of each why the group that it was last in did not get
/// anywhere.
struct Front {
  std::vector<ClusterId> live;
  std::vector<StuckReason> reasons;

  void add(ClusterId cluster, StuckReason reason) {
    live.push_back(cluster);
    reasons.push_back(reason);
  }
};

Front level0_of(const BuildPool& pool) {
  Front front;
  for (std::uint32_t c = 0; c < pool.clusters.size(); ++c) front.add(ClusterId(c), StuckReason::kNotStuck);
  return front;
}

/// False: the caller asks to stop.
bool report_level(const BuildPool& pool, const Front& front, std::uint32_t round, const DagOptions& options) {
  if (!options.on_level) return true;
  std::uint64_t triangles = 0;
  for (const ClusterId c : front.live) triangles += pool.cluster(c).triangle_count;
  return options.on_level(round, triangles);
}

/// The groups of one round, as lists of places in the front.
using Groups = std::vector<std::vector<std::uint32_t>>;

std::vector<ClusterId> clusters_of(const Front& front, const std::vector<std::uint32_t>& group) {
  std::vector<ClusterId> clusters;
  clusters.reserve(group.size());
  for (const std::uint32_t i : group) clusters.push_back(front.live[i]);
  return clusters;
}

/// The group of `clusters` as what an accepted attempt replaces it by says.
BuildGroup replaced_group(const BuildPool& pool, std::vector<ClusterId> clusters, const Attempt& attempt) {
  BuildGroup group;
  group.clusters = std::move(clusters);
  group.quadric_error = attempt.result.quadric_error;
  for (const ClusterId c : group.clusters) {
    const BuildCluster& cluster = pool.cluster(c);
    group.level = std::max(group.level, cluster.level);
    if (cluster.own_group.is_valid()) {
      group.quadric_error = std::max(group.quadric_error, pool.group(cluster.own_group).quadric_error);
    }
  }
  return group;
}

/// Adds a run of groups, and the coarser clusters that replace those that were accepted, to the pool and to the next
/// front: the same clusters where a group got stuck. In the order of groups.
void advance(BuildPool& pool, const Front& front, std::span<const std::vector<std::uint32_t>> groups,
             std::span<const Attempt> attempts, Front& next) {
  std::vector<NewClusters> accepted;
  auto cluster_count = static_cast<std::uint32_t>(pool.clusters.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Attempt& attempt = attempts[g];
    std::vector<ClusterId> clusters = clusters_of(front, groups[g]);
    if (!attempt.is_accepted) {
      const StuckReason reason = attempt.result.reason;
      for (const ClusterId c : clusters) {
        next.add(c, reason == StuckReason::kNotStuck ? StuckReason::kTooSmall : reason);
      }
      continue;
    }
    for (std::uint32_t c = 0; c < attempt.clustering.count; ++c) {
      next.add(ClusterId(cluster_count++), StuckReason::kNotStuck);
    }
    BuildGroup group = replaced_group(pool, std::move(clusters), attempt);
    accepted.push_back({attempt.result, attempt.clustering, group.level + 1, GroupId(pool.groups.size())});
    pool.groups.push_back(std::move(group));
  }
  pool.add_simplified(accepted);
}

/// Groups see nothing of each other: of those that put a vertex in the same place the first keeps it, the others try
/// again in the next round. `taken`: the places of the round's earlier groups.
void refuse_shared_places(std::span<Attempt> attempts, PlaceSet& taken) {
  for (Attempt& attempt : attempts) {
    if (!attempt.is_accepted) continue;
    const auto is_taken = [&](const Vec3i& place) { return taken.contains(place); };
    if (std::any_of(attempt.new_places.begin(), attempt.new_places.end(), is_taken)) {
      attempt.is_accepted = false;
      attempt.result.reason = StuckReason::kTopology;
    } else {
      taken.insert(attempt.new_places.begin(), attempt.new_places.end());
    }
  }
}

/// All groups of a front, a run of them at a time: what a run became is in the pool before the next one begins, so that
/// the results of a whole round are never held at once. Groups see nothing of each other (BuildPool::begin_round), so
/// that runs of any length give the same. \returns whether any group was accepted
bool run_round(BuildPool& pool, const PreparedMesh& mesh, const Groups& groups, const Shared& shared,
               std::uint32_t round, const DagOptions& options, const Effort& effort, Front& front) {
  const std::size_t run = std::max<std::size_t>(64, 16 * thread_limit());
  bool any_accepted = false;
  PlaceSet taken;
  Front next;
  pool.begin_round();
  for (std::size_t first = 0; first < groups.size(); first += run) {
    std::vector<Attempt> attempts(std::min(run, groups.size() - first));
    parallel_for_each_index(attempts.size(), 1, [&](std::size_t i) {
      const GroupTask task{round == 0 ? first_share(first + i, groups.size()) : 0.5, groups.size() == 1, effort};
      attempts[i] = attempt_group(pool, mesh, clusters_of(front, groups[first + i]), shared, task, options);
    });
    refuse_shared_places(attempts, taken);
    any_accepted = any_accepted || std::any_of(attempts.begin(), attempts.end(),
                                               [](const Attempt& attempt) { return attempt.is_accepted; });
    advance(pool, front, std::span(groups).subspan(first, attempts.size()), attempts, next);
    parallel_for_each_index(attempts.size(), 1, [&](std::size_t i) { attempts[i] = {}; });
  }
  pool.end_round();
  front = std::move(next);
  return any_accepted;
}

/// Every level of a mesh that is not empty. Error: cancelled.
Result<BuildPool> coarsen(PreparedMesh& mesh, const DagOptions& options) {
  const Clustering level0 = cluster_triangles(mesh.triangles, mesh.wedge_position, mesh.positions, options.caps);
  BuildPool pool(mesh, halved_levels(mesh));
  pool.add_level0(mesh.triangles, mesh.triangle_material, level0);
  release(mesh.triangles, mesh.triangle_material);
  Front front = level0_of(pool);
  GroupOptions grouping = options.grouping;
  if (options.max_group_bytes > 0) grouping.max_weight = options.max_group_bytes;
  std::size_t effort_index = 0;
  for (std::uint32_t round = 0;; ++round) {
    if (!report_level(pool, front, round, options)) return Error{ErrorCode::kBuildFailed, "", "cancelled"};
    if (front.live.size() == 1) front.reasons.assign(1, StuckReason::kNotStuck);
    if (front.live.size() == 1 || effort_index == std::size(kEfforts)) break;
    const Effort& effort = kEfforts[effort_index];
    grouping.target_clusters = groups_aim_at(effort, options.grouping);
    const LevelUse use = use_of_level(pool, front.live, options);
    const Groups groups = group_clusters(use.grouping, grouping);
    // Progress keeps the effort where it is; a round without any tries harder, and success at that starts over.
    const bool any_accepted = run_round(pool, mesh, groups, Shared(use, groups), round, options, effort, front);
    effort_index = any_accepted ? 0 : effort_index + 1;
  }
  add_terminal_groups(pool, front.live, grouping, options, front.reasons);
  pool.finish();
  return pool;
}

}  // namespace

Result<LodDag> build_dag(const PreparedMesh& mesh, const DagOptions& options) {
  PreparedMesh copy = mesh;
  return build_dag_and_free(copy, options);
}

Result<LodDag> build_dag_and_free(PreparedMesh& mesh, const DagOptions& options) {
  if (mesh.triangles.empty()) return LodDag{};
  TRY_LET(pool, coarsen(mesh, options));
  return assemble_dag(std::move(*pool), mesh);
}

}  // namespace meshlode::builder
