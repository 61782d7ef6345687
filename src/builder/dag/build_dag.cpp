// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/build_dag.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/local_ids.h"
#include "base/parallel.h"
#include "base/release.h"
#include "builder/dag/level_pool.h"
#include "builder/dag/level_use.h"
#include "builder/simplify/kept_topology.h"

namespace meshlode::builder {

namespace {

/// How hard a round tries. Later ones give up something to get anywhere at all.
struct Effort {
  std::uint32_t target_clusters;  ///< of groups: another size gives other neighbours
  bool may_relax_flips;
};
constexpr Effort kEfforts[] = {{20, false}, {28, false}, {13, false}, {32, true}, {24, true}};

/// What one group became, before it is accepted.
struct Attempt {
  SimplifyResult result;
  Clustering clustering;
  std::vector<Vec3i> new_places;  ///< where topology is kept
  std::uint32_t source_triangles = 0;
  bool is_accepted = false;
};

/// What the first round's groups keep: from 0.69 down to 0.35, a half on average, evenly in logarithms from the first
/// group to the last. Groups are in spatial order. If all kept a half, all errors of a level would be about equal, and
/// a cut would double its triangles at once as the threshold passes them; so the regions of a mesh are out of step, and
/// the mean deviation of a cut is close to what its threshold allows, whatever that is.
double first_share(std::size_t group, std::size_t groups) {
  constexpr double kSteps[] = {0.693, 0.635, 0.583, 0.534, 0.490,
                               0.449, 0.412, 0.378, 0.347};  // 0.49 * 2^(0.5 ... -0.5)
  constexpr std::size_t kFewest = 8;
  return groups < kFewest ? 0.5 : kSteps[group * std::size(kSteps) / groups];
}

/// How many triangles a group should keep: the share, as a whole number of full clusters, so that levels stay full.
/// Where the mesh has come to be one group, two thirds: then a level is one step of every cut, and small meshes have
/// few.
std::uint32_t target_triangles(std::uint32_t source, double share, bool is_whole, const ClusterCaps& caps) {
  constexpr std::uint32_t kFewest = 7, kMost = 12;  // clusters; below and above, a level more would gain little
  const std::uint32_t before = (source + caps.target_triangles / 2) / caps.target_triangles;
  if (is_whole && before >= kFewest && before <= kMost) return (2 * before + 1) / 3 * caps.target_triangles;
  const auto clusters = static_cast<std::uint32_t>(std::floor(share * source / caps.target_triangles + 0.5));
  const std::uint32_t target = std::max(1U, clusters) * caps.target_triangles;
  // One cluster at the end of it all may be small; but never ask for much more than the share.
  return std::min(target, std::max(1U, static_cast<std::uint32_t>(1.1 * share * source)));
}

/// Collects a group's triangles under local ids. Ids of the pool are ascending, and so are the local ones.
SimplifyInput group_input(const BuildPool& pool, const PreparedMesh& mesh, const std::vector<ClusterId>& clusters,
                          const Shared& shared) {
  SimplifyInput input;
  input.grid = mesh.grid;
  input.layout = mesh.layout;
  const std::size_t stride = mesh.layout.stride();
  std::size_t triangle_count = 0;
  for (const ClusterId c : clusters) triangle_count += pool.cluster(c).triangle_count;
  input.triangles.reserve(triangle_count);
  input.triangle_material.reserve(triangle_count);
  for (const ClusterId c : clusters) {
    const BuildCluster& cluster = pool.cluster(c);
    const auto first = static_cast<std::ptrdiff_t>(cluster.first_triangle);
    const auto last = first + static_cast<std::ptrdiff_t>(cluster.triangle_count);
    input.triangles.insert(input.triangles.end(), pool.triangles.begin() + first, pool.triangles.begin() + last);
    for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count;
         ++t) {
      input.triangle_material.push_back(pool.triangle_material[t]);
    }
  }
  LocalIds wedges(input.triangles.size());
  for (WedgeTriangle& triangle : input.triangles) {
    for (std::uint32_t& wedge : triangle) wedge = wedges.add(wedge);
  }
  const std::vector<std::uint32_t> wedge_place = wedges.sort();
  for (WedgeTriangle& triangle : input.triangles) {
    for (std::uint32_t& wedge : triangle) wedge = wedge_place[wedge];
  }
  LocalIds positions(wedges.size());
  input.wedge_position.reserve(wedges.size());
  input.is_wedge_shared.reserve(wedges.size());
  input.wedge_attributes.reserve(stride * wedges.size());
  for (const std::uint32_t w : wedges.numbers()) {
    input.wedge_position.push_back(positions.add(pool.wedge_position[w]));
    input.is_wedge_shared.push_back(shared.wedge(w));
    const auto first = pool.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride);
    input.wedge_attributes.insert(input.wedge_attributes.end(), first, first + static_cast<std::ptrdiff_t>(stride));
  }
  const std::vector<std::uint32_t> position_place = positions.sort();
  for (std::uint32_t& position : input.wedge_position) position = position_place[position];
  input.positions.reserve(positions.size());
  input.is_locked.reserve(positions.size());
  input.witnesses.reserve(positions.size());
  for (const std::uint32_t p : positions.numbers()) {
    input.positions.push_back(pool.positions[p]);
    input.is_locked.push_back(shared.position(p));
    if (!mesh.is_border_locked.empty()) {
      input.is_border_locked.push_back(p < mesh.is_border_locked.size() ? mesh.is_border_locked[p] : 0);
    }
    input.witnesses.push_back(pool.witnesses_at(p));
  }
  return input;
}

Attempt simplify_and_cluster(const SimplifyInput& input, double share, bool is_whole, const DagOptions& options,
                             const Effort& effort) {
  Attempt attempt;
  attempt.source_triangles = static_cast<std::uint32_t>(input.triangles.size());
  SimplifyOptions simplify = options.simplify;
  simplify.target_triangles = target_triangles(attempt.source_triangles, share, is_whole, options.caps);
  simplify.may_relax_flips = effort.may_relax_flips;
  attempt.result = simplify_group(input, simplify);
  const auto kept = static_cast<double>(attempt.result.triangles.size());
  if (attempt.result.triangles.empty() || kept > options.stuck_ratio * attempt.source_triangles) return attempt;
  attempt.clustering = cluster_triangles(attempt.result.triangles, attempt.result.wedge_position,
                                         attempt.result.positions, options.caps);
  attempt.is_accepted = true;
  return attempt;
}

/// Whether a group that got stuck would be reduced if its mesh's borders were not locked.
bool is_stuck_by_border(SimplifyInput& input, double share, bool is_whole, const DagOptions& options,
                        const Effort& effort) {
  const std::vector<std::uint8_t> locked = std::exchange(input.is_border_locked, {});
  if (std::find(locked.begin(), locked.end(), 1) == locked.end()) return false;
  return simplify_and_cluster(input, share, is_whole, options, effort).is_accepted;
}

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

/// One group simplified and clustered; nothing of the pool is changed. `is_whole`: it is all that is left.
Attempt attempt_group(const BuildPool& pool, const PreparedMesh& mesh, const std::vector<ClusterId>& clusters,
                      const Shared& shared, double share, bool is_whole, const DagOptions& options,
                      const Effort& effort) {
  SimplifyInput finer = group_input(pool, mesh, clusters, shared);
  if (options.simplify.keep_topology) finer.is_place_taken = [&](const Vec3i& place) { return pool.had_place(place); };
  Attempt attempt = simplify_and_cluster(finer, share, is_whole, options, effort);
  if (!attempt.is_accepted) {
    const bool is_by_border = is_stuck_by_border(finer, share, is_whole, options, effort);
    if (is_by_border) attempt.result.reason = StuckReason::kBorder;
    return attempt;
  }
  if (options.simplify.keep_topology) attempt.new_places = new_places(finer, attempt.result);
  return attempt;
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
      const double share = round == 0 ? first_share(first + i, groups.size()) : 0.5;
      attempts[i] = attempt_group(pool, mesh, clusters_of(front, groups[first + i]), shared, share, groups.size() == 1,
                                  options, effort);
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

/// The efforts' sizes are those of the usual one: where another is asked for, retries are as much larger or smaller.
std::uint32_t groups_aim_at(const Effort& effort, const GroupOptions& asked) {
  const std::uint32_t usual = GroupOptions().target_clusters;
  return std::clamp(effort.target_clusters * asked.target_clusters / usual, 2U, asked.max_clusters);
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
  Result<BuildPool> pool = coarsen(mesh, options);
  if (!pool) return pool.error();
  return assemble_dag(std::move(*pool), mesh);
}

}  // namespace meshlode::builder
