// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/dag/build_dag.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "build/dag/group_errors.h"
#include "build/dag/level_pool.h"
#include "build/dag/whole_cuts.h"

namespace meshlode::build {

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
  GroupErrors errors;
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
  const auto clusters = static_cast<std::uint32_t>(share * source / caps.target_triangles + 0.5);
  const std::uint32_t target = std::max(1U, clusters) * caps.target_triangles;
  // One cluster at the end of it all may be small; but never ask for much more than the share.
  return std::min(target, std::max(1U, static_cast<std::uint32_t>(1.1 * share * source)));
}

/// What more than one group uses, per position and per wedge of the pool.
struct Shared {
  std::vector<std::uint8_t> position, wedge;
};

/// Collects a group's triangles under local ids. Ids of the pool are ascending, and so are the local ones.
SimplifyInput group_input(const BuildPool& pool, const PreparedMesh& mesh, const std::vector<ClusterId>& clusters,
                          const Shared& shared) {
  SimplifyInput input;
  input.grid = mesh.grid;
  input.layout = mesh.layout;
  const std::size_t stride = mesh.layout.stride();
  for (const ClusterId c : clusters) {
    const BuildCluster& cluster = pool.cluster(c);
    const auto first = static_cast<std::ptrdiff_t>(cluster.first_triangle);
    const auto last = first + static_cast<std::ptrdiff_t>(cluster.triangle_count);
    input.triangles.insert(input.triangles.end(), pool.triangles.begin() + first, pool.triangles.begin() + last);
    input.triangle_material.insert(input.triangle_material.end(), pool.triangle_material.begin() + first,
                                   pool.triangle_material.begin() + last);
  }
  std::vector<std::uint32_t> wedges;
  wedges.reserve(3 * input.triangles.size());
  for (const WedgeTriangle& triangle : input.triangles) wedges.insert(wedges.end(), triangle.begin(), triangle.end());
  std::sort(wedges.begin(), wedges.end());
  wedges.erase(std::unique(wedges.begin(), wedges.end()), wedges.end());
  std::vector<std::uint32_t> positions;
  for (const std::uint32_t w : wedges) positions.push_back(pool.wedge_position[w]);
  std::sort(positions.begin(), positions.end());
  positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
  const auto index_in = [](const std::vector<std::uint32_t>& ids, std::uint32_t id) {
    return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  for (const std::uint32_t p : positions) {
    input.positions.push_back(pool.positions[p]);
    input.is_locked.push_back(shared.position[p]);
    input.witnesses.push_back(pool.witnesses[p]);
  }
  for (const std::uint32_t w : wedges) {
    input.wedge_position.push_back(index_in(positions, pool.wedge_position[w]));
    input.is_wedge_shared.push_back(shared.wedge[w]);
    const auto first = pool.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride);
    input.wedge_attributes.insert(input.wedge_attributes.end(), first, first + static_cast<std::ptrdiff_t>(stride));
  }
  for (WedgeTriangle& triangle : input.triangles) {
    for (std::uint32_t& wedge : triangle) wedge = index_in(wedges, wedge);
  }
  return input;
}

GroupInput grouping_input(const BuildPool& pool, const std::vector<ClusterId>& live, const DagOptions& options) {
  GroupInput input;
  input.position_count = static_cast<std::uint32_t>(pool.positions.size());
  std::vector<std::vector<std::uint32_t>> lists(live.size());
  input.weights.assign(live.size(), 0);
  parallel_for_each_index(live.size(), 16, [&](std::size_t i) {
    pool.positions_of(live[i], lists[i]);
    if (options.max_group_bytes == 0) return;
    input.weights[i] = options.cluster_bytes(pool.count_wedges(live[i]), pool.cluster(live[i]).triangle_count,
                                             pool.count_materials(live[i]));
  });
  input.first_position.push_back(0);
  for (std::size_t i = 0; i < live.size(); ++i) {
    input.positions.insert(input.positions.end(), lists[i].begin(), lists[i].end());
    input.first_position.push_back(static_cast<std::uint32_t>(input.positions.size()));
    Vec3d sum(0.0);
    for (const std::uint32_t p : lists[i]) sum += Vec3d(pool.positions[p]);
    input.centers.push_back(sum / static_cast<double>(std::max<std::size_t>(1, lists[i].size())));
  }
  return input;
}

Shared find_shared(const BuildPool& pool, const std::vector<ClusterId>& live,
                   const std::vector<std::vector<std::uint32_t>>& groups) {
  Shared shared{std::vector<std::uint8_t>(pool.positions.size(), 0),
                std::vector<std::uint8_t>(pool.wedge_position.size(), 0)};
  std::vector<std::uint32_t> position_owner(pool.positions.size(), kNoId);
  std::vector<std::uint32_t> wedge_owner(pool.wedge_position.size(), kNoId);
  const auto visit = [](std::uint32_t id, std::uint32_t group, std::vector<std::uint32_t>& owner,
                        std::vector<std::uint8_t>& flag) {
    if (owner[id] == kNoId) owner[id] = group;
    if (owner[id] != group) flag[id] = 1;
  };
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    for (const std::uint32_t i : groups[g]) {
      const BuildCluster& cluster = pool.cluster(live[i]);
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        for (const std::uint32_t wedge : pool.triangles[t]) {
          visit(wedge, g, wedge_owner, shared.wedge);
          visit(pool.wedge_position[wedge], g, position_owner, shared.position);
        }
      }
    }
  }
  return shared;
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

/// Ends the DAG: what is left is never replaced.
void add_terminal_groups(BuildPool& pool, const std::vector<ClusterId>& live, const GroupOptions& grouping,
                         const DagOptions& options, const std::vector<StuckReason>& reasons) {
  const std::vector<std::vector<std::uint32_t>> groups = group_clusters(grouping_input(pool, live, options), grouping);
  for (const std::vector<std::uint32_t>& members : groups) {
    BuildGroup group;
    group.is_terminal = true;
    for (const std::uint32_t i : members) {
      group.clusters.push_back(live[i]);
      group.level = std::max(group.level, pool.cluster(live[i]).level);
      if (group.stuck_reason == StuckReason::kNotStuck) group.stuck_reason = reasons[i];
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

/// Each group simplified, clustered and measured; nothing of the pool is changed.
std::vector<Attempt> attempt_groups(const BuildPool& pool, const PreparedMesh& mesh, const GroupMeter& meter,
                                    const std::vector<ClusterId>& live,
                                    const std::vector<std::vector<std::uint32_t>>& groups, bool is_first_round,
                                    const DagOptions& options, const Effort& effort) {
  const Shared shared = find_shared(pool, live, groups);
  std::vector<Attempt> attempts(groups.size());
  parallel_for_each_index(groups.size(), 1, [&](std::size_t g) {
    std::vector<ClusterId> clusters;
    for (const std::uint32_t i : groups[g]) clusters.push_back(live[i]);
    const SimplifyInput finer = group_input(pool, mesh, clusters, shared);
    const double share = is_first_round ? first_share(g, groups.size()) : 0.5;
    attempts[g] = simplify_and_cluster(finer, share, groups.size() == 1, options, effort);
    if (attempts[g].is_accepted) {
      attempts[g].errors = meter.measure(pool, clusters, finer, attempts[g].result, groups.size());
    }
  });
  return attempts;
}

/// The group of `clusters` as what an accepted attempt replaces it by says.
BuildGroup replaced_group(const BuildPool& pool, const GroupMeter& meter, std::vector<ClusterId> clusters,
                          const Attempt& attempt) {
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
  group.error = group.quadric_error;
  if (meter.is_measuring()) {
    group.deviation = attempt.errors.deviation;
    group.error = attempt.errors.error;
    group.normal_deviation = attempt.errors.normal_deviation;
    group.uv_deviation = attempt.errors.uv_deviation;
  }
  return group;
}

/// Adds the group and the coarser clusters that replace it.
void accept(BuildPool& pool, const GroupMeter& meter, std::vector<ClusterId> clusters, const Attempt& attempt,
            Front& next) {
  BuildGroup group = replaced_group(pool, meter, std::move(clusters), attempt);
  if (meter.is_measuring()) {
    for (const ClusterId c : group.clusters) pool.cluster(c).samples = {};  // carried on by the coarser clusters
  }
  const GroupId group_id(pool.groups.size());
  const std::uint32_t level = group.level + 1;
  pool.groups.push_back(std::move(group));
  const auto first = static_cast<std::uint32_t>(pool.clusters.size());
  pool.add_simplified(attempt.result, attempt.errors.carried, attempt.clustering, level, group_id);
  for (std::uint32_t c = first; c < pool.clusters.size(); ++c) next.add(ClusterId(c), StuckReason::kNotStuck);
}

/// The next front: coarser clusters where a group was accepted, the same ones where it got stuck. In the order of
/// groups.
Front advance(BuildPool& pool, const GroupMeter& meter, const Front& front,
              const std::vector<std::vector<std::uint32_t>>& groups, std::vector<Attempt> attempts) {
  Front next;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<ClusterId> clusters;
    for (const std::uint32_t i : groups[g]) clusters.push_back(front.live[i]);
    if (attempts[g].is_accepted) {
      accept(pool, meter, std::move(clusters), attempts[g], next);
      attempts[g] = {};
      continue;
    }
    const StuckReason reason = attempts[g].result.reason;
    for (const ClusterId c : clusters) {
      next.add(c, reason == StuckReason::kNotStuck ? StuckReason::kTooSmall : reason);
    }
  }
  return next;
}

Result<LodDag> coarsen(const PreparedMesh& mesh, const DagOptions& options) {
  BuildPool pool(mesh);
  if (mesh.triangles.empty()) return LodDag{};
  const GroupMeter meter(mesh, options.error);
  pool.add_clusters(mesh.triangles, mesh.triangle_material, meter.level0(),
                    cluster_triangles(mesh.triangles, mesh.wedge_position, mesh.positions, options.caps), 0, GroupId());
  Front front = level0_of(pool);
  GroupOptions grouping = options.grouping;
  if (options.max_group_bytes > 0) grouping.max_weight = options.max_group_bytes;
  std::size_t effort_index = 0;
  for (std::uint32_t round = 0;; ++round) {
    if (!report_level(pool, front, round, options)) return Error{ErrorCode::kBuildFailed, "", "cancelled"};
    if (front.live.size() == 1) front.reasons.assign(1, StuckReason::kNotStuck);
    if (front.live.size() == 1 || effort_index == std::size(kEfforts)) break;
    const Effort& effort = kEfforts[effort_index];
    grouping.target_clusters = effort.target_clusters;
    const auto groups = group_clusters(grouping_input(pool, front.live, options), grouping);
    std::vector<Attempt> attempts = attempt_groups(pool, mesh, meter, front.live, groups, round == 0, options, effort);
    // Progress keeps the effort where it is; a round without any tries harder, and success at that starts over.
    const bool any_accepted =
        std::any_of(attempts.begin(), attempts.end(), [](const Attempt& attempt) { return attempt.is_accepted; });
    effort_index = any_accepted ? 0 : effort_index + 1;
    front = advance(pool, meter, front, groups, std::move(attempts));
  }
  add_terminal_groups(pool, front.live, grouping, options, front.reasons);
  return assemble_dag(pool, mesh);
}

}  // namespace

Result<LodDag> build_dag(const PreparedMesh& mesh, const DagOptions& options) {
  Result<LodDag> dag = coarsen(mesh, options);
  if (dag && options.error == ErrorSource::kMeasured) hold_to_whole_cuts(mesh, kMeasuredMargin, *dag);
  return dag;
}

}  // namespace meshlode::build
