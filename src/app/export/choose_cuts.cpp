// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export/choose_cuts.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <span>

namespace meshlode::app {
namespace {

/// The cut of the groups that pass (`passes[g - first_group]`).
run::UniformCut collect_cut(const run::Asset& asset, const format::MeshRecord& mesh, const std::vector<bool>& passes) {
  run::UniformCut cut;
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
std::vector<bool> passing_groups(const run::Asset& asset, const format::MeshRecord& mesh,
                                 std::span<const run::ClusterInstance> drawn) {
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

/// What a budget's threshold is compared with; division by one unit keeps the order of errors (I4).
double scaled_error(const format::GroupRecord& group, double unit) {
  if (!(group.error < format::kInfiniteError)) return std::numeric_limits<double>::infinity();
  return static_cast<double>(group.error) / unit;
}

/// At `threshold` and beyond, the number of triangles drawn changes by `triangles`.
struct BudgetEvent {
  double threshold;
  std::int64_t triangles;
};

/// A cluster is drawn from the error of its own group on (level 0: from the beginning), up to that of its coarser one.
void add_budget_events(const run::Asset& asset, const format::MeshRecord& mesh, double unit,
                       std::vector<BudgetEvent>& events) {
  for (std::uint32_t c = mesh.first_cluster; c < mesh.first_cluster + mesh.cluster_count; ++c) {
    const format::ClusterRecord& cluster = asset.clusters()[c];
    const double first =
        cluster.own_group == format::kNone ? -1.0 : scaled_error(asset.groups()[cluster.own_group], unit);
    const double last = scaled_error(asset.groups()[cluster.coarser_group], unit);
    if (!(first < last)) continue;
    events.push_back({first, cluster.triangle_count()});
    if (last < std::numeric_limits<double>::infinity())
      events.push_back({last, -std::int64_t{cluster.triangle_count()}});
  }
}

}  // namespace

BudgetCuts choose_budget_cuts(const run::Asset& asset, std::span<const double> units, std::uint64_t max_triangles) {
  assert(units.size() == asset.meshes().size());
  std::vector<BudgetEvent> events;
  for (std::size_t m = 0; m < units.size(); ++m) {
    if (units[m] > 0.0) add_budget_events(asset, asset.meshes()[m], units[m], events);
  }
  std::sort(events.begin(), events.end(),
            [](const BudgetEvent& a, const BudgetEvent& b) { return a.threshold < b.threshold; });
  BudgetCuts result;
  result.threshold = -1.0;
  result.is_met = events.empty();
  std::int64_t triangles = 0;
  for (std::size_t i = 0; i < events.size() && !result.is_met;) {
    result.threshold = events[i].threshold;
    for (; i < events.size() && events[i].threshold == result.threshold; ++i) triangles += events[i].triangles;
    result.is_met = static_cast<std::uint64_t>(triangles) <= max_triangles;
  }
  result.triangles = static_cast<std::uint64_t>(triangles);
  result.cuts.resize(units.size());
  for (std::size_t m = 0; m < units.size(); ++m) {
    if (!(units[m] > 0.0)) continue;
    const format::MeshRecord& mesh = asset.meshes()[m];
    std::vector<bool> passes(mesh.group_count);
    for (std::uint32_t g = 0; g < mesh.group_count; ++g) {
      const double error = scaled_error(asset.groups()[mesh.first_group + g], units[m]);
      passes[g] = error < std::numeric_limits<double>::infinity() && error <= result.threshold;
    }
    result.cuts[m] = collect_cut(asset, mesh, passes);
  }
  return result;
}

run::UniformCut choose_level_cut(const run::Asset& asset, MeshId mesh, std::uint32_t level) {
  const format::MeshRecord& record = asset.meshes()[mesh.value];
  std::vector<bool> passes(record.group_count);
  for (std::uint32_t g = 0; g < record.group_count; ++g) {
    const format::GroupRecord& group = asset.groups()[record.first_group + g];
    passes[g] = (group.flags & format::kGroupTerminal) == 0 && group.level < level;
  }
  return collect_cut(asset, record, passes);
}

std::vector<run::UniformCut> choose_camera_cuts(const run::Asset& asset, const run::Camera& camera, double pixel_error,
                                                const run::AttributeBounds& bounds) {
  const std::vector<run::ClusterInstance> drawn = run::select_flat(asset, camera, pixel_error, bounds);
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
  std::vector<run::UniformCut> cuts(asset.meshes().size());
  for (std::size_t m = 0; m < cuts.size(); ++m) {
    if (!passes[m].empty()) cuts[m] = collect_cut(asset, asset.meshes()[m], passes[m]);
  }
  return cuts;
}

}  // namespace meshlode::app
