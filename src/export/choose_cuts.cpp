// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/choose_cuts.h"

#include <algorithm>
#include <span>

namespace meshlode {
namespace {

/// The cut of the groups that pass (`passes[g - first_group]`).
UniformCut collect_cut(const Asset& asset, const format::MeshRecord& mesh, const std::vector<bool>& passes) {
  UniformCut cut;
  double error = 0.0;
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[c];
    const bool own_passes = cluster.own_group == format::kNone || passes[cluster.own_group - mesh.first_group];
    if (!own_passes || passes[cluster.coarser_group - mesh.first_group]) continue;
    cut.clusters.emplace_back(c);
    if (cluster.own_group != format::kNone) {
      error = std::max(error, static_cast<double>(asset.groups()[cluster.own_group].error));
    }
  }
  cut.stored_error = std::max(error, static_cast<double>(mesh.level0_deviation));
  return cut;
}

/// Which groups pass, told from what is drawn: a group passes iff a cluster made from it is drawn, or was replaced in
/// turn. Groups lie coarse to fine and so do clusters, so one walk in file order meets the coarser side first.
std::vector<bool> passing_groups(const Asset& asset, const format::MeshRecord& mesh,
                                 std::span<const ClusterInstance> drawn) {
  std::vector<bool> passes(mesh.group_count, false);
  std::size_t next = 0;
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    while (next < drawn.size() && drawn[next].cluster < ClusterId(c)) ++next;
    const bool is_drawn = next < drawn.size() && drawn[next].cluster == ClusterId(c);
    const format::ClusterRecord& cluster = asset.clusters()[c];
    if (cluster.own_group != format::kNone && (is_drawn || passes[cluster.coarser_group - mesh.first_group])) {
      passes[cluster.own_group - mesh.first_group] = true;
    }
  }
  return passes;
}

}  // namespace

UniformCut choose_level_cut(const Asset& asset, MeshId mesh, std::uint32_t level) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<bool> passes(record.group_count);
  for (std::uint32_t g = 0; g < record.group_count; ++g) {
    const format::GroupRecord& group = asset.groups()[record.first_group + g];
    passes[g] = (group.flags & format::kGroupTerminal) == 0 && group.level < level;
  }
  return collect_cut(asset, record, passes);
}

std::vector<UniformCut> choose_camera_cuts(const Asset& asset, const Camera& camera, double pixel_error) {
  const std::vector<ClusterInstance> drawn = select_flat(asset, camera, pixel_error);
  std::vector<std::vector<bool>> passes(asset.meshes().size());  // empty: no instance yet
  for (std::size_t first = 0; first < drawn.size();) {
    std::size_t last = first;
    while (last < drawn.size() && drawn[last].instance == drawn[first].instance) ++last;
    const std::uint32_t mesh = asset.instances()[drawn[first].instance.value].mesh;
    std::vector<bool> own = passing_groups(asset, asset.meshes()[mesh], std::span(drawn).subspan(first, last - first));
    if (passes[mesh].empty()) {
      passes[mesh] = std::move(own);
    } else {
      for (std::size_t g = 0; g < own.size(); ++g) passes[mesh][g] = passes[mesh][g] && own[g];
    }
    first = last;
  }
  std::vector<UniformCut> cuts(asset.meshes().size());
  for (std::size_t m = 0; m < cuts.size(); ++m) {
    if (!passes[m].empty()) cuts[m] = collect_cut(asset, asset.meshes()[m], passes[m]);
  }
  return cuts;
}

}  // namespace meshlode
