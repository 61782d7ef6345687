// SPDX-License-Identifier: GPL-3.0-or-later
#include "builder/dag/group_attempt.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "builder/dag/group_input.h"
#include "builder/simplify/kept_topology.h"

namespace meshlode::builder {

namespace {

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

Attempt simplify_and_cluster(const SimplifyInput& input, const GroupTask& task, const DagOptions& options) {
  Attempt attempt;
  attempt.source_triangles = static_cast<std::uint32_t>(input.triangles.size());
  SimplifyOptions simplify = options.simplify;
  simplify.target_triangles = target_triangles(attempt.source_triangles, task.share, task.is_whole, options.caps);
  simplify.may_relax_flips = task.effort.may_relax_flips;
  attempt.result = options.simplify_group(input, simplify);
  const auto kept = static_cast<double>(attempt.result.triangles.size());
  if (attempt.result.triangles.empty() || kept > options.stuck_ratio * attempt.source_triangles) return attempt;
  attempt.clustering = cluster_triangles(attempt.result.triangles, attempt.result.wedge_position,
                                         attempt.result.positions, options.caps);
  attempt.is_accepted = true;
  return attempt;
}

/// Whether a group that got stuck would be reduced if its mesh's borders were not locked.
bool is_stuck_by_border(SimplifyInput& input, const GroupTask& task, const DagOptions& options) {
  const std::vector<std::uint8_t> locked = std::exchange(input.is_border_locked, {});
  if (std::find(locked.begin(), locked.end(), 1) == locked.end()) return false;
  return simplify_and_cluster(input, task, options).is_accepted;
}

}  // namespace

std::uint32_t groups_aim_at(const Effort& effort, const GroupOptions& asked) {
  const std::uint32_t usual = GroupOptions().target_clusters;
  return std::clamp(effort.target_clusters * asked.target_clusters / usual, 2U, asked.max_clusters);
}

double first_share(std::size_t group, std::size_t groups) {
  constexpr double kSteps[] = {0.693, 0.635, 0.583, 0.534, 0.490,
                               0.449, 0.412, 0.378, 0.347};  // 0.49 * 2^(0.5 ... -0.5)
  constexpr std::size_t kFewest = 8;
  return groups < kFewest ? 0.5 : kSteps[group * std::size(kSteps) / groups];
}

Attempt attempt_group(const BuildPool& pool, const PreparedMesh& mesh, const std::vector<ClusterId>& clusters,
                      const Shared& shared, const GroupTask& task, const DagOptions& options) {
  SimplifyInput finer = group_input(pool, mesh, clusters, shared);
  finer.gap_reach = mesh.gap_reach;
  if (options.simplify.keep_topology) finer.is_place_taken = [&](const Vec3i& place) { return pool.had_place(place); };
  Attempt attempt = simplify_and_cluster(finer, task, options);
  if (!attempt.is_accepted) {
    const bool is_by_border = is_stuck_by_border(finer, task, options);
    if (is_by_border) attempt.result.reason = StuckReason::kBorder;
    return attempt;
  }
  if (options.simplify.keep_topology) attempt.new_places = new_places(finer, attempt.result);
  return attempt;
}

}  // namespace meshlode::builder
