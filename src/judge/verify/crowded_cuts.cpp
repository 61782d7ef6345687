// SPDX-License-Identifier: GPL-3.0-or-later
// How many edges of cuts have more than two triangles: no fault where topology may be broken on purpose, but to be
// known by whoever asks for manifolds; a fault where the asset says that it keeps topology.
#include <algorithm>
#include <array>
#include <cstdio>
#include <string>
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
    for (const auto& t : surface.triangles(c)) {
      const std::array<std::uint32_t, 3> p{position[t[0]], position[t[1]], position[t[2]]};
      // On the grid it is an edge: what lies on both sides of it meets there.
      const bool is_edge = p[0] == p[1] || p[1] == p[2] || p[2] == p[0];
      if (!is_edge) counter.add(p);
    }
  }
  return counter.count();
}

}  // namespace

void count_crowded_cuts(const run::Asset& asset, const MeshSurface& surface, std::uint32_t count, bool keeps_topology,
                        CrowdedTotals& totals, RuleLog& log) {
  if (count == 0 || surface.cluster_count == 0) return;
  EdgeCounter counter;
  std::vector<ClusterId> level0;
  for (std::uint32_t c = surface.first_cluster; c < surface.first_cluster + surface.cluster_count; ++c) {
    if (asset.clusters()[c].own_group == format::kNone) level0.emplace_back(c);
  }
  const std::uint64_t of_source = count_cut(surface, level0, counter).crowded;
  totals.of_source += of_source;
  ++totals.cuts;
  std::uint64_t most = 0;
  for (const float error : errors_to_cut_at(asset, surface, count)) {
    const run::UniformCut cut = run::select_uniform(asset, surface.mesh, double{error});
    const std::uint64_t of_cut = count_cut(surface, cut.clusters, counter).crowded;
    most = std::max(most, of_cut);
    ++totals.cuts;
    if (!keeps_topology) continue;
    log.expect(
        of_cut <= of_source, Rule::kV207,
        [&] {
          char text[64];
          std::snprintf(text, sizeof text, ", uniform cut at %.9g", double{error});
          return "mesh " + std::to_string(surface.mesh.value) + text;
        },
        [&] { return differs("edges of more than two triangles", of_cut, "at level 0", of_source); });
  }
  totals.of_cuts += most;
}

}  // namespace meshlode::judge
