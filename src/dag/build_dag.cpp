// SPDX-License-Identifier: GPL-3.0-or-later
#include "dag/build_dag.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "dag/level_pool.h"

namespace meshlode {

namespace {

/// How hard a round tries. Later ones give up something to get anywhere at all.
struct Effort {
  std::uint32_t target_clusters;  ///< of groups: another size gives other neighbours
  bool may_relax_flips;
};
constexpr Effort kEfforts[] = {{16, false}, {24, false}, {11, false}, {32, true}, {24, true}};

/// What one group became, before it is accepted.
struct Attempt {
  SimplifyResult result;
  Clustering clustering;
  std::uint32_t source_triangles = 0;
  bool is_accepted = false;
};

/// How many triangles a group should keep: half, as a whole number of full clusters, so that levels stay full.
std::uint32_t target_triangles(std::uint32_t source, const ClusterCaps& caps) {
  const std::uint32_t clusters = std::max(1U, (source + caps.target_triangles) / (2 * caps.target_triangles));
  const std::uint32_t target = clusters * caps.target_triangles;
  // One cluster at the end of it all may be small; but never ask for more than half.
  return std::min(target, std::max(1U, source * 11 / 20));
}

/// Collects a group's triangles under local ids, in order of first use.
class GroupInputBuilder {
 public:
  GroupInputBuilder(const BuildPool& pool, const PreparedMesh& mesh) : pool_(pool), mesh_(mesh) {}

  SimplifyInput build(const std::vector<std::uint32_t>& clusters, const std::vector<std::uint8_t>& is_shared) {
    SimplifyInput input;
    input.grid = mesh_.grid;
    input.layout = mesh_.layout;
    const std::size_t stride = mesh_.layout.stride();
    std::vector<std::uint32_t> wedges;
    for (const std::uint32_t c : clusters) {
      const BuildCluster& cluster = pool_.clusters[c];
      for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
        wedges.insert(wedges.end(), pool_.triangles[t].begin(), pool_.triangles[t].end());
        input.triangles.push_back(pool_.triangles[t]);
        input.triangle_material.push_back(pool_.triangle_material[t]);
      }
    }
    // Wedges by position and attributes: two clusters of different parents may hold the same wedge under two ids.
    std::sort(wedges.begin(), wedges.end());
    wedges.erase(std::unique(wedges.begin(), wedges.end()), wedges.end());
    std::vector<std::uint32_t> by_content = wedges;
    const auto compare = [&](std::uint32_t a, std::uint32_t b) {
      if (pool_.wedge_position[a] != pool_.wedge_position[b]) return pool_.wedge_position[a] < pool_.wedge_position[b] ? -1 : 1;
      const float* x = pool_.wedge_attributes.data() + a * stride;
      const float* y = pool_.wedge_attributes.data() + b * stride;
      for (std::size_t j = 0; j < stride; ++j) {
        if (x[j] != y[j]) return x[j] < y[j] ? -1 : 1;
      }
      return 0;
    };
    std::sort(by_content.begin(), by_content.end(), [&](std::uint32_t a, std::uint32_t b) {
      const int order = compare(a, b);
      return order != 0 ? order < 0 : a < b;
    });
    std::vector<std::uint32_t> local(wedges.size());
    for (std::size_t i = 0; i < by_content.size(); ++i) {
      const std::uint32_t w = by_content[i];
      const bool is_new_position = i == 0 || pool_.wedge_position[w] != pool_.wedge_position[by_content[i - 1]];
      if (is_new_position) {
        input.positions.push_back(pool_.positions[pool_.wedge_position[w]]);
        input.is_locked.push_back(is_shared[pool_.wedge_position[w]]);
      }
      if (i == 0 || compare(w, by_content[i - 1]) != 0) {
        input.wedge_position.push_back(static_cast<std::uint32_t>(input.positions.size() - 1));
        input.wedge_attributes.insert(input.wedge_attributes.end(), pool_.wedge_attributes.begin() + static_cast<std::ptrdiff_t>(w * stride),
                                      pool_.wedge_attributes.begin() + static_cast<std::ptrdiff_t>((w + 1) * stride));
      }
      const auto slot = std::lower_bound(wedges.begin(), wedges.end(), w) - wedges.begin();
      local[static_cast<std::size_t>(slot)] = static_cast<std::uint32_t>(input.wedge_position.size() - 1);
    }
    for (WedgeTriangle& triangle : input.triangles) {
      for (std::uint32_t& wedge : triangle) {
        wedge = local[static_cast<std::size_t>(std::lower_bound(wedges.begin(), wedges.end(), wedge) - wedges.begin())];
      }
    }
    return input;
  }

 private:
  const BuildPool& pool_;
  const PreparedMesh& mesh_;
};

GroupInput grouping_input(const BuildPool& pool, const std::vector<std::uint32_t>& live, const DagOptions& options) {
  GroupInput input;
  input.position_count = static_cast<std::uint32_t>(pool.positions.size());
  std::vector<std::vector<std::uint32_t>> lists(live.size());
  input.weights.assign(live.size(), 0);
  parallel_for_each_index(live.size(), 16, [&](std::size_t i) {
    pool.positions_of(live[i], lists[i]);
    if (options.max_group_bytes == 0) return;
    input.weights[i] = options.cluster_bytes(pool.count_wedges(live[i]), pool.clusters[live[i]].triangle_count,
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

/// Per position: used by more than one group.
std::vector<std::uint8_t> find_shared(const GroupInput& input, const std::vector<std::vector<std::uint32_t>>& groups) {
  constexpr std::uint32_t kNobody = 0xFFFFFFFFU;
  std::vector<std::uint32_t> owner(input.position_count, kNobody);
  std::vector<std::uint8_t> is_shared(input.position_count, 0);
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    for (const std::uint32_t c : groups[g]) {
      for (std::uint32_t i = input.first_position[c]; i < input.first_position[c + 1]; ++i) {
        const std::uint32_t p = input.positions[i];
        if (owner[p] == kNobody) owner[p] = g;
        if (owner[p] != g) is_shared[p] = 1;
      }
    }
  }
  return is_shared;
}

Attempt simplify_and_cluster(const SimplifyInput& input, const DagOptions& options, const Effort& effort) {
  Attempt attempt;
  attempt.source_triangles = static_cast<std::uint32_t>(input.triangles.size());
  SimplifyOptions simplify = options.simplify;
  simplify.target_triangles = target_triangles(attempt.source_triangles, options.caps);
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
void add_terminal_groups(BuildPool& pool, const std::vector<std::uint32_t>& live, const GroupOptions& grouping,
                         const DagOptions& options, const std::vector<StuckReason>& reasons) {
  const std::vector<std::vector<std::uint32_t>> groups = group_clusters(grouping_input(pool, live, options), grouping);
  for (const std::vector<std::uint32_t>& members : groups) {
    BuildGroup group;
    group.is_terminal = true;
    for (const std::uint32_t i : members) {
      group.clusters.push_back(live[i]);
      group.level = std::max(group.level, pool.clusters[live[i]].level);
      if (group.stuck_reason == StuckReason::kNotStuck) group.stuck_reason = reasons[i];
    }
    pool.groups.push_back(std::move(group));
  }
}

}  // namespace

Result<LodDag> build_dag(const PreparedMesh& mesh, const DagOptions& options) {
  BuildPool pool(mesh);
  if (mesh.triangles.empty()) return LodDag{};
  pool.add_clusters(mesh.triangles, mesh.triangle_material,
                    cluster_triangles(mesh.triangles, mesh.wedge_position, mesh.positions, options.caps), 0, 0xFFFFFFFFU);
  std::vector<std::uint32_t> live(pool.clusters.size());
  for (std::uint32_t c = 0; c < live.size(); ++c) live[c] = c;

  GroupOptions grouping = options.grouping;
  if (options.max_group_bytes > 0) grouping.max_weight = options.max_group_bytes;
  std::vector<StuckReason> reasons(live.size(), StuckReason::kNotStuck);
  std::size_t effort_index = 0;
  for (std::uint32_t round = 0;; ++round) {
    if (options.on_level) {
      std::uint64_t triangles = 0;
      for (const std::uint32_t c : live) triangles += pool.clusters[c].triangle_count;
      if (!options.on_level(round, triangles)) return Error{ErrorCode::kBuildFailed, "", "cancelled"};
    }
    if (live.size() == 1 || effort_index == std::size(kEfforts)) {
      if (live.size() == 1) reasons.assign(1, StuckReason::kNotStuck);
      add_terminal_groups(pool, live, grouping, options, reasons);
      break;
    }
    const Effort& effort = kEfforts[effort_index];
    grouping.target_clusters = effort.target_clusters;
    const GroupInput input = grouping_input(pool, live, options);
    const std::vector<std::vector<std::uint32_t>> groups = group_clusters(input, grouping);
    const std::vector<std::uint8_t> is_shared = find_shared(input, groups);

    std::vector<Attempt> attempts(groups.size());
    parallel_for_each_index(groups.size(), 1, [&](std::size_t g) {
      std::vector<std::uint32_t> clusters;
      for (const std::uint32_t i : groups[g]) clusters.push_back(live[i]);
      GroupInputBuilder builder(pool, mesh);
      attempts[g] = simplify_and_cluster(builder.build(clusters, is_shared), options, effort);
    });

    std::vector<std::uint32_t> next;
    std::vector<StuckReason> next_reasons;
    bool any_accepted = false;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      Attempt& attempt = attempts[g];
      if (!attempt.is_accepted) {
        for (const std::uint32_t i : groups[g]) {
          next.push_back(live[i]);
          next_reasons.push_back(attempt.result.reason == StuckReason::kNotStuck ? StuckReason::kTooSmall
                                                                                : attempt.result.reason);
        }
        continue;
      }
      any_accepted = true;
      BuildGroup group;
      group.quadric_error = attempt.result.quadric_error;
      for (const std::uint32_t i : groups[g]) {
        const BuildCluster& cluster = pool.clusters[live[i]];
        group.clusters.push_back(live[i]);
        group.level = std::max(group.level, cluster.level);
        if (cluster.own_group != 0xFFFFFFFFU) {
          group.quadric_error = std::max(group.quadric_error, pool.groups[cluster.own_group].quadric_error);
        }
      }
      group.error = group.quadric_error;  // the qem tier
      const auto group_id = static_cast<std::uint32_t>(pool.groups.size());
      const std::uint32_t level = group.level + 1;
      pool.groups.push_back(std::move(group));
      const auto first = static_cast<std::uint32_t>(pool.clusters.size());
      pool.add_simplified(attempt.result, attempt.clustering, level, group_id);
      for (std::uint32_t c = first; c < pool.clusters.size(); ++c) {
        next.push_back(c);
        next_reasons.push_back(StuckReason::kNotStuck);
      }
      attempt = {};
    }
    live = std::move(next);
    reasons = std::move(next_reasons);
    // Progress keeps the effort where it is; a round without any tries harder, and success at that starts over.
    effort_index = any_accepted ? 0 : effort_index + 1;
  }
  return assemble_dag(pool, mesh);
}

}  // namespace meshlode
