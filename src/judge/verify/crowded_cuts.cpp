// SPDX-License-Identifier: GPL-3.0-or-later
// How many edges of cuts have more than two triangles: no fault, since topology may be broken on purpose, but to be
// known by whoever asks for manifolds.
#include <algorithm>
#include <vector>

#include "judge/metrics/crowded_edges.h"
#include "judge/verify/cuts.h"

namespace meshlode::judge {

namespace {

/// `count` errors of groups, evenly by rank, the largest among them; fewer where there are fewer.
std::vector<float> errors_to_cut_at(const run::Asset& asset, const MeshSurface& surface, std::uint32_t count) {
  std::vector<float> errors = finite_group_errors(asset, surface);
  if (errors.size() <= count) return errors;
  std::vector<float> chosen;
  for (std::uint32_t i = 1; i <= count; ++i) chosen.push_back(errors[i * errors.size() / count - 1]);
  return chosen;
}

EdgeCounts count_cut(const MeshSurface& surface, std::span<const ClusterId> clusters, EdgeCounter& counter) {
  for (const ClusterId id : clusters) {
    const std::uint32_t c = id.value - surface.first_cluster;
    const std::uint32_t* position = &surface.vertex_position[surface.first_vertex[c]];
    for (const auto& t : surface.triangles(c)) counter.add({position[t[0]], position[t[1]], position[t[2]]});
  }
  return counter.count();
}

}  // namespace

void count_crowded_cuts(const run::Asset& asset, const MeshSurface& surface, std::uint32_t count,
                        CrowdedTotals& totals) {
  if (count == 0 || surface.cluster_count == 0) return;
  EdgeCounter counter;
  std::vector<ClusterId> level0;
  for (std::uint32_t c = surface.first_cluster; c < surface.first_cluster + surface.cluster_count; ++c) {
    if (asset.clusters()[c].own_group == format::kNone) level0.emplace_back(c);
  }
  totals.of_source += count_cut(surface, level0, counter).crowded;
  ++totals.cuts;
  std::uint64_t most = 0;
  for (const float error : errors_to_cut_at(asset, surface, count)) {
    const run::UniformCut cut = run::select_uniform(asset, surface.mesh, double{error});
    most = std::max(most, count_cut(surface, cut.clusters, counter).crowded);
    ++totals.cuts;
  }
  totals.of_cuts += most;
}

}  // namespace meshlode::judge
